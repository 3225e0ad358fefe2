//! The system packages that the build needs, and their installation on Debian 12.

use std::process::Command;

use crate::chore::{Chores, Failure, ask, command, works};

/// One system package.
struct Package {
    name: &'static str,
    /// The version that works must begin with this; empty where any will do.
    version: &'static str,
    reason: &'static str,
}

const fn package(name: &'static str, version: &'static str, reason: &'static str) -> Package {
    Package { name, version, reason }
}

/// OCCT renamed its toolkits in 7.8; ours link by the names of 7.6.
const OCCT: &str = "7.6";

/// Everything that a bare Debian 12 with a Rust toolchain lacks.
const PACKAGES: &[Package] = &[
    package("g++", "", "C++17 compiler for cpp/"),
    package("make", "", "builds opencascade-sys's bridge, by way of cmake"),
    package("cmake", "", "opencascade-sys finds OCCT through it"),
    package(
        "libcgal-dev",
        "5.5",
        "CGAL: triangulation, self-intersection, booleans; brings GMP, MPFR and Boost",
    ),
    package("libopenmesh-dev", "9.", "OpenMesh: half-edge meshes, cleaning, decimation"),
    package("libosd-dev", "3.5", "OpenSubdiv: limit surfaces"),
    package("libocct-foundation-dev", OCCT, "OpenCascade: basics"),
    package("libocct-modeling-data-dev", OCCT, "OpenCascade: curves, surfaces, shapes"),
    package("libocct-modeling-algorithms-dev", OCCT, "OpenCascade: solids, booleans, checks"),
    package("libocct-ocaf-dev", OCCT, "OpenCascade: names and colours of products"),
    package("libocct-data-exchange-dev", OCCT, "OpenCascade: STEP"),
    package(
        "libocct-visualization-dev",
        OCCT,
        "OpenCascade: NCollection_AliasedArray.hxx, which its mesh headers include and Debian files here",
    ),
    package("libeigen3-dev", "3.", "Eigen: wanted by OpenMesh's headers"),
    package("libgl1", "", "outside readers: cadquery-ocp loads it"),
    package("python3", "", "outside readers"),
    package("python3-venv", "", "outside readers: their own environment under target/"),
];

/// Installs what is missing, and says first what that is.
///
/// # Errors
/// No rights, no network, or a library of a version that the code does not compile with.
pub(crate) fn install(chores: &mut Chores) -> Result<(), Failure> {
    if !is_debian() {
        print_needs("This system has no dpkg and apt-get, so nothing is installed here.");
        println!("Going on: the build will say what it does not find.");
        return Ok(());
    }
    let missing = missing();
    if missing.is_empty() {
        println!("system packages: all {} are installed", PACKAGES.len());
    } else {
        println!("system packages to install:");
        missing.iter().for_each(|package| println!("  {:<34} {}", package.name, package.reason));
        fetch(chores, &missing)?;
    }
    check_versions()
}

fn is_debian() -> bool {
    let runs = |program: &str| ask(program, &["--version"]).is_some_and(|o| o.status.success());
    runs("dpkg-query") && runs("apt-get")
}

fn fetch(chores: &mut Chores, missing: &[&Package]) -> Result<(), Failure> {
    let names: Vec<&str> = missing.iter().map(|package| package.name).collect();
    let by_hand = format!("By hand, as root: apt-get install {}", names.join(" "));
    if !is_root() && ask("sudo", &["--version"]).is_none() {
        return Err(Failure::new("packages are missing, and there is neither root nor sudo", by_hand));
    }
    chores.run("package lists", apt(&["update"]), &by_hand)?;
    let arguments = [&["install", "-y", "--no-install-recommends"], names.as_slice()].concat();
    chores.run("system packages", apt(&arguments), &by_hand)?;
    match self::missing()[..] {
        [] => Ok(()),
        [package, ..] => Err(Failure::new(format!("{} is still not installed", package.name), by_hand)),
    }
}

/// `apt-get`, by sudo where one is not root.
fn apt(arguments: &[&str]) -> Command {
    const QUIET: &str = "DEBIAN_FRONTEND=noninteractive";
    let program: &[&str] = if is_root() { &["env", QUIET] } else { &["sudo", "env", QUIET] };
    command(program[0], &[&program[1..], &["apt-get"], arguments].concat())
}

fn is_root() -> bool {
    ask("id", &["-u"]).is_some_and(|output| output.stdout.trim_ascii() == b"0")
}

fn missing() -> Vec<&'static Package> {
    let installed = installed();
    PACKAGES.iter().filter(|package| !installed.iter().any(|(name, _)| name == package.name)).collect()
}

/// Names and versions of those of our packages that are installed.
fn installed() -> Vec<(String, String)> {
    const FORMAT: &str = "--showformat=${Package} ${db:Status-Status} ${Version}\n";
    let names: Vec<&str> = PACKAGES.iter().map(|package| package.name).collect();
    let output = ask("dpkg-query", &[&["--show", FORMAT], names.as_slice()].concat());
    output.map(|o| parse_installed(&String::from_utf8_lossy(&o.stdout))).unwrap_or_default()
}

fn parse_installed(lines: &str) -> Vec<(String, String)> {
    let row = |line: &str| match line.split(' ').collect::<Vec<_>>()[..] {
        [name, "installed", version] => Some((name.to_owned(), version.to_owned())),
        _ => None,
    };
    lines.lines().filter_map(row).collect()
}

/// Other releases carry other versions; better told here than by a C++ compiler.
fn check_versions() -> Result<(), Failure> {
    let wrong = wrong_versions(&installed());
    if wrong.is_empty() {
        return Ok(());
    }
    print_needs("The libraries that this system offers are not those that the code is made for.");
    Err(Failure::new(
        wrong.join("; "),
        "Use Debian 12 (bookworm), or install the versions above another way.",
    ))
}

fn wrong_versions(installed: &[(String, String)]) -> Vec<String> {
    let wrong = |(name, version): &(String, String)| {
        let package = PACKAGES.iter().find(|package| package.name == name)?;
        let bare = version.split_once(':').map_or(version.as_str(), |(_epoch, rest)| rest);
        let fits = bare.starts_with(package.version);
        (!fits).then(|| format!("{name} is {version}, and {}* is needed", package.version))
    };
    installed.iter().filter_map(wrong).collect()
}

fn print_needs(opening: &str) {
    println!("{opening}\nNeeded, by their names in Debian 12 (any other source of the same will do):");
    for Package { name, version, reason } in PACKAGES {
        let version = if version.is_empty() { String::new() } else { format!("{version}*") };
        println!("  {name:<34} {version:<6} {reason}");
    }
}

/// The toolchain's own helpers, which minimal toolchains leave out.
///
/// # Errors
/// Names the missing component and how it is added.
pub(crate) fn require_components() -> Result<(), Failure> {
    for component in ["fmt", "clippy"] {
        if !works(crate::chore::cargo(&[component, "--version"])) {
            return Err(Failure::new(
                format!("this Rust toolchain has no `cargo {component}`"),
                "With rustup: rustup component add rustfmt clippy",
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_dpkg_calls_installed_counts() {
        let said = "cmake installed 3.25.1-1\nlibosd-dev not-installed \nlibcgal-dev config-files 5.5.1-2\n";
        assert_eq!(parse_installed(said), [("cmake".to_owned(), "3.25.1-1".to_owned())]);
    }

    #[test]
    fn a_newer_occt_is_told_with_its_version() {
        let versions = |occt: &str| vec![("libocct-foundation-dev".to_owned(), occt.to_owned())];
        assert_eq!(wrong_versions(&versions("7.6.3+dfsg1-7.1")), Vec::<String>::new());
        let told = wrong_versions(&versions("7.8.1+dfsg1-3"));
        assert!(told[0].contains("7.8.1") && told[0].contains("7.6"), "{told:?}");
    }

    #[test]
    fn an_epoch_is_no_part_of_the_version() {
        assert!(wrong_versions(&[("libcgal-dev".to_owned(), "1:5.5.1-2".to_owned())]).is_empty());
    }

    #[test]
    fn every_package_is_listed_once_with_its_reason() {
        for (i, package) in PACKAGES.iter().enumerate() {
            assert!(!package.reason.is_empty(), "{}", package.name);
            assert!(PACKAGES[..i].iter().all(|other| other.name != package.name), "{}", package.name);
        }
    }
}
