use saoms_api::{Message, Topic};

use super::{MessageValidator, Problem, Sender};
use crate::grid::Map;
use crate::hardware::Area;

/// Maximum period of a component, a day, in microseconds.
pub(crate) const LONGEST_PERIOD: u64 = 24 * 60 * 60 * 1_000_000;

/// A message that can be wrong.
///
/// Landings and take-offs are not checked: every number of pieces is possible.
pub(crate) trait Validate: Message {
    /// Name of the message for people.
    const WHAT: &'static str;

    /// Topic on which components are known by the numbers as which they send it; `None` if it names no speaker.
    const SPOKEN_ON: Option<Topic<Self>> = None;

    /// The robot or luggage that the message is about, for people.
    fn about(&self) -> String;

    /// Checks the message of this sender.
    fn validate(&self, sender: Sender<'_>, validator: &mut MessageValidator, area: Option<&Map>)
    -> Result<(), Problem>;
}

/// The robot of a message, for people.
pub(crate) fn of_robot(robot: u32) -> String {
    format!("robot {robot}")
}

impl Validate for Area {
    const WHAT: &'static str = "an area";

    fn about(&self) -> String {
        format!("{} x {} blocks", self.width, self.height)
    }

    fn validate(
        &self,
        _sender: Sender<'_>,
        _intake: &mut MessageValidator,
        _area: Option<&Map>,
    ) -> Result<(), Problem> {
        let Area { width, height, .. } = *self;
        match Option::<Map>::from(self.clone()) {
            Some(_) => Ok(()),
            None => Err(Problem::Area { width, height }),
        }
    }
}
