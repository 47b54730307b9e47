//! What `saoms --version` prints.

use crate::support::{saoms, stdout};

#[test]
fn the_version_says_which_build_it_is() {
    let short = format!("saoms {}\n", env!("CARGO_PKG_VERSION"));
    assert_eq!(stdout(&saoms(&["-V"])), short);
    let long = stdout(&saoms(&["--version"]));
    let rest = long.strip_prefix(&short).unwrap();
    let starts = ["commit: ", "target: ", "plugins: version ", "transports: version "];
    let lines: Vec<&str> = rest.lines().collect();
    let fits = lines.iter().zip(starts).all(|(line, start)| line.len() > start.len() && line.starts_with(start));
    assert!(fits && lines.len() == starts.len(), "{long}");
    assert!(lines[1].contains(std::env::consts::ARCH), "{long}");
}
