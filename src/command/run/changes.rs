//! Changes of the fleet while it runs: what other files would change, and the change itself.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

use saoms_api::Level;
use saoms_api::host::{format_duration, one_line};
use saoms_control::{ChangeAnswer, ChangeFailure, ChangeRequest};
use saoms_core::schedule::{ChangeError, ChangeOptions, ChangeWithdrawal, Handle, PlannedRefusal};
use saoms_lang::assembly::{Assembly, RunPolicy};
use saoms_lang::diagnostic::Severity;
use saoms_lang::project::{Compilation, INPUT};
use saoms_lang::source::{LineColumn, Location, Sources};
use saoms_tools::diagnostics::from_folder;
use serde_json::Value;

use super::applied::LastApplied;
use super::reload::libraries;
use super::web::WebAccesses;
use super::{RunArguments, settled};
use crate::arguments::FleetArguments;
use crate::fleet::{DiagnosticReport, project};
use crate::plugins::CommandClasses;

/// The way from files to changes of a fleet.
pub(super) struct FleetChanges {
    handle: Handle,
    /// Severities that the command line of the run sets by its other options.
    settled: Vec<String>,
    /// The node that runs.
    node: Option<String>,
    /// What the composites said of the run when it started.
    run: RunPolicy,
    /// The web servers that calls were allowed to.
    web: WebAccesses,
    /// The last one that was applied, where there is a state folder.
    applied: Option<LastApplied>,
    present: Mutex<PresentFleet>,
}

/// The files of the fleet that runs.
#[derive(Clone)]
pub(super) struct PresentFleet {
    pub(super) files: FleetArguments,
    /// The libraries of its classes and loops.
    pub(super) libraries: Vec<PathBuf>,
    /// The files of composites and values that were read.
    pub(super) read: Vec<PathBuf>,
    /// The time at which somebody began to read them.
    pub(super) since: SystemTime,
}

/// Files that were read for a change.
pub(super) struct WantedFleet {
    pub(super) answer: ChangeAnswer,
    /// The fleet; `None` where they describe none.
    pub(super) assembly: Option<Assembly>,
    /// The texts that were read.
    sources: Sources,
    /// The files of composites and values that were read.
    pub(super) read: Vec<PathBuf>,
    /// The time at which that began.
    pub(super) since: SystemTime,
    /// True once whoever asked for the change has taken it back.
    pub(super) is_withdrawn: bool,
}

impl FleetChanges {
    /// Those of a run, whose composites say this of it and call these servers, with its libraries, its other files, and
    /// the time at which they were read; and what was applied before, where there is a state folder.
    pub(super) fn new(
        handle: Handle,
        arguments: &RunArguments,
        (run, web): (RunPolicy, WebAccesses),
        (libraries, read, since): (Vec<PathBuf>, Vec<PathBuf>, SystemTime),
        applied: Option<LastApplied>,
    ) -> FleetChanges {
        let present = PresentFleet { files: arguments.fleet.clone(), libraries, read, since };
        let (settled, node) = (settled(arguments), arguments.node.clone());
        FleetChanges { handle, settled, node, run, web, applied, present: Mutex::new(present) }
    }

    fn lock(&self) -> MutexGuard<'_, PresentFleet> {
        self.present.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The files of the fleet that runs.
    pub(super) fn present(&self) -> PresentFleet {
        self.lock().clone()
    }

    /// Why the fleet cannot become this one because of the web servers that it would call.
    pub(super) fn web_refusal(&self, wanted: &Assembly) -> Option<String> {
        self.web.refusal(&WebAccesses::of(wanted))
    }

    /// Answers a client: what would change, and where there is a way to take that back, what has changed. An error is
    /// one of this program.
    pub(super) fn answer(
        &self,
        request: &ChangeRequest,
        withdrawal: Option<ChangeWithdrawal>,
    ) -> Result<ChangeAnswer, String> {
        let files = self.files(request)?;
        let mut wanted = self.read(&files, request.coloured, &request.folder)?;
        let wait = request.wait().unwrap_or(ChangeOptions::WAIT);
        let (allow_loss, by) = (request.allow_loss, request.by.clone());
        let options = |withdrawal| ChangeOptions { allow_loss, wait, by, withdrawal, keeps: None };
        self.settle(&mut wanted, &files, withdrawal.map(options));
        if wanted.is_withdrawn {
            let text = "a change of the fleet is taken back: whoever asked for it does not wait any more";
            self.handle.note(Level::Info, text.to_owned());
        }
        wanted.answer.diagnostics.iter_mut().for_each(|one| shorten(one, &request.folder));
        let refused = wanted.answer.plan.iter_mut().flat_map(|plan| &mut plan.refused);
        for at in refused.filter_map(|refusal| refusal.at.as_mut()) {
            *at = from_folder(at, &request.folder).to_owned();
        }
        Ok(wanted.answer)
    }

    /// The files that a client names.
    fn files(&self, request: &ChangeRequest) -> Result<FleetArguments, String> {
        let present = self.present().files;
        if request.files.is_empty() {
            return Err("there are no `files`".to_owned());
        }
        if request.files.iter().any(|file| file == Path::new(INPUT)) {
            return Err(
                "the program of the fleet reads the files, which standard input of a command cannot be".to_owned()
            );
        }
        if !request.folder.is_absolute() {
            return Err("`folder` has to be an absolute path".to_owned());
        }
        let path = |path: &PathBuf| request.path(path);
        let mut plugins = present.plugins;
        let new = request.plugins.iter().map(path).filter(|path| !plugins.plugins.contains(path));
        let new: Vec<PathBuf> = new.collect();
        plugins.plugins.extend(new);
        Ok(FleetArguments {
            files: request.files.iter().map(path).collect(),
            settings: request.set.clone(),
            severities: request.severities.clone(),
            plugins,
            allow_outside: request.allow_outside,
            max_size: request.max_size.unwrap_or(present.max_size),
        })
    }

    /// Reads and checks files as at the start of a run, and tells what is found to a reader in this folder.
    pub(super) fn read(&self, files: &FleetArguments, coloured: bool, folder: &Path) -> Result<WantedFleet, String> {
        let since = SystemTime::now();
        let classes = CommandClasses::new(&files.plugins);
        let classes = classes.map_err(|_| "the classes of this program contradict each other")?;
        let project = project(files).severities(self.settled.iter().cloned());
        let mut compilation: Compilation<Assembly> = project.node(self.node.clone()).to_start().compile(&classes);
        let whole = compilation.output.take();
        let shown = DiagnosticReport::from(&compilation);
        let mut answer = ChangeAnswer {
            diagnostics: shown.values(),
            text: shown.human_in(Severity::Note, coloured).seen_from(folder).to_string(),
            ..ChangeAnswer::default()
        };
        let faults = compilation.problems.iter().filter(|one| one.is_error).map(|one| one.text.as_str());
        let faults: Vec<&str> = faults.collect();
        answer.notes = compilation.problems.iter().filter(|one| !one.is_error).map(|one| one.text.clone()).collect();
        let assembly = whole.filter(|_| faults.is_empty());
        if assembly.is_none() {
            let error = if faults.is_empty() { "the files describe no fleet".to_owned() } else { faults.join("; ") };
            answer.failure = Some(ChangeFailure { error, refused: true, busy: false });
        }
        let assembly = assembly.map(|whole| self.node.iter().fold(whole, |whole, node| whole.at(node)));
        let sources = compilation.sources;
        let read = sources.open().files_read();
        Ok(WantedFleet { answer, assembly, sources, read, since, is_withdrawn: false })
    }

    /// Finds out what a wanted fleet changes, and changes it where there are options for that.
    pub(super) fn settle(&self, wanted: &mut WantedFleet, files: &FleetArguments, options: Option<ChangeOptions>) {
        let WantedFleet { answer, assembly, sources, read, since, is_withdrawn } = wanted;
        answer.applied = options.as_ref().map(|_| false);
        let Some(assembly) = assembly else { return };
        if assembly.components.is_empty() {
            let error = "this fleet has no components: `saoms down` ends the run".to_owned();
            answer.failure = Some(ChangeFailure { error, refused: true, busy: false });
            return;
        }
        if let Some(error) = self.web_refusal(assembly) {
            answer.failure = Some(ChangeFailure { error, refused: true, busy: false });
            return;
        }
        if assembly.run != self.run {
            answer.notes.push(
                "what the composites say of the run itself, such as the targets of alerts, stays as it was at its start"
                    .to_owned(),
            );
        }
        let mut plan = self.handle.plan(assembly);
        locate(&mut plan.refused, assembly, sources);
        answer.plan = Some(plan);
        let Some(mut options) = options else { return };
        let wait = options.wait;
        options.keeps = self.applied.as_ref().and_then(|one| one.of(assembly, &files.files, options.by.clone()));
        match self.handle.apply(assembly, options) {
            Ok(changed) => {
                answer.applied = Some(true);
                *self.lock() = PresentFleet {
                    files: files.clone(),
                    libraries: libraries(assembly),
                    read: read.clone(),
                    since: *since,
                };
                if !changed.plan.is_empty() {
                    self.handle.note(Level::Info, format!("the fleet has changed: {}", changed.plan.summary()));
                }
                if !changed.unfinished.is_empty() {
                    let text = format!(
                        "`{}` ended without having finished within {}: what was begun is handed over as after `saoms stop`",
                        changed.unfinished.join("`, `"),
                        format_duration(wait)
                    );
                    answer.notes.push(one_line(&text).into_owned());
                }
                // The fleet may have changed since it was planned first.
                answer.plan = Some(changed.plan);
            }
            Err(error) => {
                *is_withdrawn = error == ChangeError::Withdrawn;
                let refused = matches!(error, ChangeError::Refused(_) | ChangeError::LosesState { .. });
                let busy = matches!(error, ChangeError::Busy);
                let error = one_line(&error.to_string()).into_owned();
                answer.failure = Some(ChangeFailure { error, refused, busy });
            }
        }
    }
}

/// Says where the components are written that refusals are about.
fn locate(refused: &mut [PlannedRefusal], assembly: &Assembly, sources: &Sources) {
    for refusal in refused {
        let place = refusal.component.as_deref().and_then(|component| assembly.places.get(component, ""));
        refusal.at = place.map(|Location { file, span }| {
            let file = sources.get(file);
            let LineColumn { line, column } = file.line_column(span.start);
            format!("{}:{line}:{column}", file.path())
        });
    }
}

/// Calls files as they are called in the folder of a client.
fn shorten(value: &mut Value, folder: &Path) {
    match value {
        Value::Object(all) => all.iter_mut().for_each(|(name, value)| match value {
            Value::String(path) if name == "file" => *path = from_folder(path, folder).to_owned(),
            value => shorten(value, folder),
        }),
        Value::Array(all) => all.iter_mut().for_each(|one| shorten(one, folder)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn paths_of_files_alone_are_shortened() {
        let mut found = json!([{
            "file": "/a/b/fleet.composite",
            "message": "`/a/b/` is no class",
            "labels": [{"file": "/a/b/../other.composite", "text": "/a/b/x"}, {"file": "/a/bc", "text": ""}],
        }]);
        shorten(&mut found, Path::new("/a/b"));
        let expected = json!([{
            "file": "fleet.composite",
            "message": "`/a/b/` is no class",
            "labels": [{"file": "../other.composite", "text": "/a/b/x"}, {"file": "/a/bc", "text": ""}],
        }]);
        assert_eq!(found, expected);
    }
}
