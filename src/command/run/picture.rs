//! The picture of the composites of a running fleet, for its dashboard.

use std::fs;
use std::path::Path;

use saoms_lang::project::INPUT;
use saoms_tools::graph::{Diagram, svg};

use super::changes::PresentFleet;
use crate::fleet::{compiled, files_read};
use crate::output::displayed;

/// Draws the composites as `saoms graph` does. They are read again, since a fleet that nobody looks at is to cost
/// nothing: what was changed since its start would show another fleet, and is refused.
pub(super) fn drawn(present: &PresentFleet) -> Result<String, String> {
    let PresentFleet { files: fleet, since: started, .. } = present;
    if fleet.files.iter().any(|file| file == Path::new(INPUT)) {
        return Err("the composite came from standard input, which cannot be read again".to_owned());
    }
    let unreadable = "the composites cannot be read any more: the log of the run says why";
    let compilation = compiled(fleet, |project, classes| project.census(classes)).map_err(|_| unreadable)?;
    let is_new = |file: &&std::path::PathBuf| {
        fs::metadata(file).and_then(|file| file.modified()).is_ok_and(|changed| changed > *started)
    };
    if let Some(changed) = files_read(&compilation, fleet).iter().find(is_new) {
        return Err(format!(
            "`{}` has changed since the fleet started: `saoms graph` draws it as it is now",
            displayed(changed)
        ));
    }
    let census = compilation.output.as_ref().ok_or(unreadable)?;
    Ok(svg(&Diagram::of(&compilation.contribution, &compilation.registry, census)).to_string())
}
