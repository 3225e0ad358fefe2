//! Running one command after another, each printed first and timed.

use std::fmt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

/// Why a chore stopped, and what the user can do about it.
#[derive(Debug)]
pub(crate) struct Failure {
    what: String,
    mend: String,
}

impl Failure {
    pub(crate) fn new(what: impl Into<String>, mend: impl Into<String>) -> Self {
        Self { what: what.into(), mend: mend.into() }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}\n  {}", self.what, self.mend)
    }
}

/// The workspace root, wherever the command was started.
pub(crate) fn root() -> &'static Path {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
    manifest.ancestors().nth(2).unwrap_or(manifest)
}

/// Where cargo puts what it builds; `CARGO_TARGET_DIR` is respected.
pub(crate) fn target() -> PathBuf {
    root().join(std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into()))
}

/// The cargo that started us, so that a chosen toolchain stays chosen.
pub(crate) fn cargo(arguments: &[&str]) -> Command {
    command(std::env::var("CARGO").as_deref().unwrap_or("cargo"), arguments)
}

/// A command that will run at the workspace root.
pub(crate) fn command(program: impl AsRef<std::ffi::OsStr>, arguments: &[&str]) -> Command {
    let mut command = Command::new(program);
    command.args(arguments).current_dir(root());
    command
}

/// A command's output, when it could be started at all.
pub(crate) fn ask(program: &str, arguments: &[&str]) -> Option<Output> {
    command(program, arguments).output().ok()
}

/// Whether a command can be started and ends well.
pub(crate) fn works(mut command: Command) -> bool {
    command.output().is_ok_and(|output| output.status.success())
}

/// The steps done so far and how long each took.
pub(crate) struct Chores {
    begun: Instant,
    done: Vec<(String, Duration)>,
}

impl Chores {
    pub(crate) fn new() -> Self {
        Self { begun: Instant::now(), done: Vec::new() }
    }

    /// Prints the command and runs it on this terminal; `mend` is told when it fails.
    pub(crate) fn run(&mut self, name: &str, mut command: Command, mend: &str) -> Result<(), Failure> {
        println!("\n$ {}", shown(&command));
        let begun = Instant::now();
        let status = command.status();
        self.done.push((name.to_owned(), begun.elapsed()));
        match status {
            Ok(status) if status.success() => Ok(()),
            Ok(status) => Err(Failure::new(format!("{name} failed ({status})"), mend)),
            Err(error) => Err(Failure::new(format!("{name} could not be started: {error}"), mend)),
        }
    }

    /// The closing table: seconds per step, and in all.
    pub(crate) fn print_times(&self) {
        if self.done.is_empty() {
            return;
        }
        println!();
        for (name, time) in &self.done {
            println!("{:>8.1} s  {name}", time.as_secs_f64());
        }
        println!("{:>8.1} s  in all", self.begun.elapsed().as_secs_f64());
    }
}

/// The command as one could type it: program name, arguments, and the variables set for it.
fn shown(command: &Command) -> String {
    let variables = command.get_envs().filter_map(|(key, value)| {
        value.map(|value| format!("{}={}", key.to_string_lossy(), value.to_string_lossy()))
    });
    let program = Path::new(command.get_program());
    let short = match program.strip_prefix(root()) {
        Ok(inside) => inside.as_os_str(),
        Err(_) => program.file_name().unwrap_or(program.as_os_str()),
    };
    let words = std::iter::once(short).chain(command.get_args());
    variables.chain(words.map(|word| quoted(&word.to_string_lossy()))).collect::<Vec<_>>().join(" ")
}

fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=:+,@".contains(c);
    if !word.is_empty() && word.chars().all(plain) { word.to_owned() } else { format!("'{word}'") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_holds_the_workspace() {
        let manifest = std::fs::read_to_string(root().join("Cargo.toml")).unwrap();
        assert!(manifest.contains("[workspace]"));
    }

    #[test]
    fn commands_are_shown_as_typed() {
        let mut command = command("/usr/bin/apt-get", &["install", "a b"]);
        command.env("DEBIAN_FRONTEND", "noninteractive");
        assert_eq!(shown(&command), "DEBIAN_FRONTEND=noninteractive apt-get install 'a b'");
    }

    #[test]
    fn a_failing_command_is_a_failure_that_names_the_step_and_the_mend() {
        let mut chores = Chores::new();
        let failure = chores.run("the step", command("false", &[]), "do this").unwrap_err().to_string();
        assert!(failure.contains("the step failed") && failure.contains("do this"), "{failure}");
        let absent = chores.run("ghost", command("no-such-program-here", &[]), "install it").unwrap_err();
        assert!(absent.to_string().contains("could not be started"));
        assert_eq!(chores.done.len(), 2);
    }
}
