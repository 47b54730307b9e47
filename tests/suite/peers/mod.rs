//! Foreign programs that ours has to agree with. A test finds or installs its peer, and is skipped with a word where
//! that fails; `SAOMS_PEERS=required`, which `.ci/run` sets, makes it fail then.

mod book;
pub(crate) mod browser;
mod messages;
mod rosbags;
pub(crate) mod web;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A Python that has a package of this minor version: that of the system, or one in `target` with this very version,
/// which is installed at the first time. `None` if the test is to be skipped.
#[expect(clippy::print_stdout, reason = "a test that is skipped says so")]
pub(crate) fn python(package: &str, version: &str) -> Option<PathBuf> {
    let own = Path::new(env!("CARGO_TARGET_TMPDIR")).join("peers").join(format!("{package}-{version}"));
    let found = [PathBuf::from("python3"), own.join("bin/python")];
    if let Some(python) = found.into_iter().find(|python| has(python, package, version)) {
        return Some(python);
    }
    let installed = install(&own, package, version);
    if installed.is_none() {
        let missing =
            format!("{package} is missing: there is no Python 3 with it, and pip cannot install {package}=={version}");
        assert!(std::env::var("SAOMS_PEERS").as_deref() != Ok("required"), "{missing}");
        println!("skipped: {missing}");
    }
    installed
}

fn has(python: &Path, package: &str, version: &str) -> bool {
    let (minor, _) = version.rsplit_once('.').unwrap();
    let looks = format!(
        "from importlib.metadata import version\n\
         assert version('{package}').rpartition('.')[0] == '{minor}'"
    );
    succeeds(Command::new(python).args(["-c", &looks]))
}

/// Installs beside the place, which then appears as a whole: other test programs may do the same at the same time.
fn install(own: &Path, package: &str, version: &str) -> Option<PathBuf> {
    let beside = own.with_extension(std::process::id().to_string());
    fs::create_dir_all(own.parent()?).ok()?;
    let _ = fs::remove_dir_all(own);
    let wanted = format!("{package}=={version}");
    let options = ["-m", "pip", "install", "--quiet", "--retries", "0", "--timeout", "20", &wanted];
    let done = succeeds(Command::new("python3").args(["-m", "venv"]).arg(&beside))
        && succeeds(Command::new(beside.join("bin/python")).args(options))
        && fs::rename(&beside, own).is_ok();
    let _ = fs::remove_dir_all(&beside);
    let python = own.join("bin/python");
    (done || has(&python, package, version)).then_some(python)
}

fn succeeds(command: &mut Command) -> bool {
    let quiet = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    quiet.status().is_ok_and(|status| status.success())
}
