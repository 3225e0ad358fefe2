//! Compiles `cpp/` for crates/kernel: one object per file, and only what has changed since the last build.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::time::SystemTime;
use std::{env, fs, thread};

type Outcome<T = ()> = Result<T, Box<dyn Error + Send + Sync>>;

/// Relative to crates/kernel, where the build script runs.
const CPP: &str = "../../cpp";
const LIBRARIES: [&str; 4] = ["cgal", "opensubdiv", "openmesh", "occt"];
const BRIDGES: [&str; 5] = ["common", "cgal", "opensubdiv", "openmesh", "occt"];
const INCLUDE_ROOTS: [&str; 2] = ["/usr/include", "/usr/local/include"];

/// A header that must be there, and the Debian 12 packages that bring it.
const NEEDED: [(&str, &str); 4] = [
    ("CGAL/version.h", "libcgal-dev"),
    ("opensubdiv/version.h", "libosd-dev"),
    ("OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh", "libopenmesh-dev"),
    (
        "opencascade/STEPCAFControl_Writer.hxx",
        "libocct-foundation-dev libocct-modeling-data-dev libocct-modeling-algorithms-dev \
         libocct-data-exchange-dev libocct-ocaf-dev",
    ),
];

/// Users before used, as the linker wants them.
const LINKED: [&str; 34] = [
    "osdCPU",
    "OpenMeshTools",
    "OpenMeshCore",
    "mpfr",
    "gmp",
    "TKXDESTEP",
    "TKXDEIGES",
    "TKSTEP",
    "TKSTEPAttr",
    "TKSTEP209",
    "TKSTEPBase",
    "TKIGES",
    "TKXCAF",
    "TKVCAF",
    "TKCAF",
    "TKLCAF",
    "TKCDF",
    "TKXSBase",
    "TKOffset",
    "TKFillet",
    "TKBool",
    "TKMesh",
    "TKBO",
    "TKPrim",
    "TKShHealing",
    "TKTopAlgo",
    "TKGeomAlgo",
    "TKBRep",
    "TKGeomBase",
    "TKG3d",
    "TKG2d",
    "TKMath",
    "TKernel",
    "stdc++",
];

#[allow(clippy::print_stderr)] // Cargo shows what a build script says there
fn main() {
    if let Err(error) = build_cpp() {
        eprintln!("{error}");
        std::process::exit(1);
    }
}

fn build_cpp() -> Outcome {
    println!("cargo:rerun-if-changed=../../build.rs");
    let missing = missing_packages();
    if !missing.is_empty() {
        return Err(format!("C++ headers are missing. On Debian 12: apt-get install {missing}").into());
    }
    let bridges = BRIDGES.map(|name| format!("src/bridge/{name}.rs"));
    bridges.iter().for_each(|bridge| println!("cargo:rerun-if-changed={bridge}"));
    let mut build = cxx_build::bridges(bridges);
    configure(&mut build)?;
    let mut sources = cpp_sources()?;
    sources.extend(build.get_files().map(Path::to_path_buf));
    let objects = compile(&build, &sources)?;
    cc::Build::new().cpp(true).cpp_link_stdlib(None).objects(objects).try_compile("softfold_native")?;
    for library in LINKED {
        println!("cargo:rustc-link-lib=dylib={library}");
    }
    Ok(())
}

fn missing_packages() -> String {
    let found = |header: &str| INCLUDE_ROOTS.iter().any(|root| Path::new(root).join(header).exists());
    let packages = NEEDED.iter().filter(|(header, _)| !found(header)).map(|(_, packages)| *packages);
    packages.collect::<Vec<_>>().join(" ")
}

/// `NDEBUG` because a failed `assert` in a library would end the process; `CGAL_DEBUG` because CGAL's own checks throw
/// instead, and user data needs them.
fn configure(build: &mut cc::Build) -> Outcome {
    build
        .std("c++17")
        .opt_level(2)
        .debug(false)
        .include(CPP)
        .define("NDEBUG", None)
        .define("CGAL_DEBUG", None);
    build.flag("-Wno-maybe-uninitialized"); // g++ 12 reports it inside of OpenMesh's templates, without cause
    for root in INCLUDE_ROOTS {
        build.flag("-isystem").flag(format!("{root}/opencascade"));
    }
    Ok(())
}

/// Every .cc below the four library folders, the slowest first; tells Cargo to watch all that lies there.
fn cpp_sources() -> Outcome<Vec<PathBuf>> {
    println!("cargo:rerun-if-changed={CPP}");
    let mut sources = vec![];
    for library in LIBRARIES {
        let mut files = fs::read_dir(Path::new(CPP).join(library))?
            .map(|entry| entry.map(|entry| entry.path()))
            .collect::<Result<Vec<_>, _>>()?;
        files.retain(|file| file.extension().is_some_and(|extension| extension == "cc"));
        files.sort();
        sources.extend(files);
    }
    Ok(sources)
}

/// Units compiled at a time, at most, whatever `cargo build -j` says: one CGAL unit takes up to 2.6 GB.
const JOBS_MAX: usize = 2;

/// Compiles what is stale, as many at a time as Cargo and [`JOBS_MAX`] allow, and gives all objects.
fn compile(build: &cc::Build, sources: &[PathBuf]) -> Outcome<Vec<PathBuf>> {
    let out = PathBuf::from(env::var("OUT_DIR")?).join("objects");
    fs::create_dir_all(&out)?;
    let tool = build.try_get_compiler()?;
    let flags = format!("{:?} {:?}", tool.path(), tool.args());
    let unit = |source: &PathBuf| Unit::new(source, &out);
    let units: Vec<Unit> = sources.iter().map(unit).collect();
    let stale = Mutex::new(units.iter().filter(|unit| unit.is_stale(&flags)));
    let jobs: usize = env::var("NUM_JOBS")?.parse()?;
    let jobs = jobs.clamp(1, JOBS_MAX);
    let next = || stale.lock().ok().and_then(|mut stale| stale.next());
    let work = || -> Outcome {
        while let Some(unit) = next() {
            unit.compile(tool.to_command(), &flags)?;
        }
        Ok(())
    };
    thread::scope(|scope| {
        let workers: Vec<_> = (0..jobs).map(|_| scope.spawn(work)).collect();
        workers.into_iter().try_for_each(|worker| worker.join().map_err(|_| "a worker panicked")?)
    })?;
    Ok(units.into_iter().map(|unit| unit.object).collect())
}

/// One source file, its object, the compiler's list of what it includes, and the command that made it.
struct Unit {
    source: PathBuf,
    object: PathBuf,
    dependencies: PathBuf,
    command: PathBuf,
}

impl Unit {
    fn new(source: &Path, out: &Path) -> Self {
        let folder = source.parent().and_then(Path::file_name).unwrap_or_default().to_string_lossy();
        let name = source.file_name().unwrap_or_default().to_string_lossy();
        let file = |extension: &str| out.join(format!("{folder}-{name}.{extension}"));
        Self { source: source.into(), object: file("o"), dependencies: file("d"), command: file("command") }
    }

    fn is_stale(&self, flags: &str) -> bool {
        let same_command = fs::read_to_string(&self.command).is_ok_and(|command| command == flags);
        !same_command || self.is_older_than_sources().unwrap_or(true)
    }

    /// None if something is not there.
    fn is_older_than_sources(&self) -> Option<bool> {
        let made = modified(&self.object)?;
        let rule = fs::read_to_string(&self.dependencies).ok()?.replace("\\\n", " ");
        let (_, files) = rule.split_once(": ")?;
        let times: Option<Vec<_>> = files.split_whitespace().map(|file| modified(Path::new(file))).collect();
        Some(times?.into_iter().any(|time| time > made))
    }

    fn compile(&self, mut compiler: Command, flags: &str) -> Outcome {
        let _ = fs::remove_file(&self.command); // an interrupted run must not look finished
        compiler.arg("-c").arg(&self.source).arg("-o").arg(&self.object);
        let done = compiler.arg("-MD").arg("-MF").arg(&self.dependencies).output()?;
        let said = String::from_utf8_lossy(&done.stderr);
        if !done.status.success() {
            return Err(format!("{} does not compile:\n{said}", self.source.display()).into());
        }
        said.lines().for_each(|line| println!("cargo:warning={line}"));
        fs::write(&self.command, flags)?;
        Ok(())
    }
}

fn modified(file: &Path) -> Option<SystemTime> {
    fs::metadata(file).ok()?.modified().ok()
}
