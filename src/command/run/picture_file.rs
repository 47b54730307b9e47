use std::sync::{Mutex, MutexGuard, PoisonError};

use saoms_api::extension::{PictureRegistration, RunPicture};
use saoms_api::host::TopicDeclaration;
use saoms_core::observe::{Interest, Observer, SentMessage};
use saoms_core::report::RunReport;
use saoms_lang::assembly::{Assembly, Traffic};

use super::outputs::Output;
use super::summary::outcome;

/// The observer that writes a picture of the run (`--paths`), drawn by the crate of components that registered it.
pub(super) struct PictureFile {
    pub(super) output: Output,
    title: String,
    picture: Mutex<Box<dyn RunPicture>>,
}

impl PictureFile {
    pub(super) fn new(
        output: Output,
        title: String,
        picture: &PictureRegistration,
        assembly: &Assembly,
    ) -> PictureFile {
        let mut picture = (picture.new)();
        for component in &assembly.components {
            for wire in component.references.iter() {
                for target in &wire.targets {
                    picture.wire(&component.path, &wire.reference, &assembly.components[target.component].path);
                }
            }
        }
        for topic in &Traffic::of(assembly).topics {
            for reader in &topic.readers {
                picture.reader(&topic.name, &assembly.components[reader.component()].path);
            }
        }
        PictureFile { output, title, picture: Mutex::new(picture) }
    }

    fn picture(&self) -> MutexGuard<'_, Box<dyn RunPicture>> {
        self.picture.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Observer for PictureFile {
    fn interest(&self) -> Interest {
        Interest::NONE
    }

    fn wants_topic(&self, name: &str, declared: &TopicDeclaration<'_>) -> bool {
        self.picture().wants_topic(name, declared)
    }

    fn message(&self, sent: &SentMessage) {
        self.picture().message(&sent.topic, &sent.component, &sent.message);
    }

    fn end(&self, report: &RunReport) {
        let picture = self.picture().draw(&self.title, &outcome(report));
        self.output.write(|to| to.write_all(picture.as_bytes()));
    }
}
