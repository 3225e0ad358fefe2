//! Other people's programs that read what softfold wrote; `cargo xtask test` sets them up.

#![allow(dead_code, reason = "each test binary uses its part")]

use serde_json::Value;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Set to `required` by `cargo xtask test`: absent readers are then a failure.
const SWITCH: &str = "SOFTFOLD_READERS";

/// What a reader says of some files, in their order; `None` where the readers are not set up.
pub(crate) fn ask(script: &str, files: &[PathBuf]) -> Option<Vec<Value>> {
    assert!(!files.is_empty(), "{script}: no files to read");
    let output = python(script)?.args(files).output().expect("the reader starts");
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{script}: {complaint}");
    let said: Value =
        serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{script}: {e}\n{complaint}"));
    Some(files.iter().map(|file| facts(&said, file)).collect())
}

/// The readers' own test, on files with planted faults: its list of failures; `None` where the readers are not set up.
pub(crate) fn self_test() -> Option<Value> {
    let output = python("selftest.py")?.output().expect("the reader starts");
    let (said, complaint) =
        (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "selftest.py: {}\n{said}\n{complaint}", output.status);
    Some(serde_json::from_str(&said).unwrap_or_else(|e| panic!("selftest.py: {e}\n{said}\n{complaint}")))
}

fn facts(said: &Value, file: &Path) -> Value {
    let facts = &said[file.to_string_lossy().as_ref()];
    assert!(facts.is_object(), "nothing is said of {}", file.display());
    assert!(facts["error"].is_null(), "{}: {}", file.display(), facts["error"]);
    facts.clone()
}

fn python(script: &str) -> Option<Command> {
    let environment = Path::new(env!("CARGO_TARGET_TMPDIR")).join("../readers-venv");
    // Written last when the environment is set up: half an environment is none.
    if !environment.join("softfold-requirements").is_file() {
        let required = std::env::var(SWITCH).is_ok_and(|value| value == "required");
        assert!(!required, "the outside readers are not set up in {}", environment.display());
        // Not by a macro: the test harness would keep that to itself.
        let _ = writeln!(
            std::io::stderr(),
            "\n*** skipped: {script} has no outside readers; run: cargo xtask test ***"
        );
        return None;
    }
    let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/readers");
    let mut command = Command::new(environment.join("bin/python"));
    command.arg("-B").arg(scripts.join(script));
    Some(command)
}
