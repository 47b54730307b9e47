//! Hardware that no program takes back: it notes outside of the program what it does, and remembers it.

mod note;

use std::collections::BTreeMap;
use std::path::Path;

use saoms_api::{Class, Component, Context, Failure, Own};
use saoms_components::grid::{Block, Map};
use saoms_components::hardware::{Action, Area, Hardware, Progress};

use note::{Note, add, notes};

const SIDE: u32 = 5;

#[derive(Class)]
#[class(name = "test.Yard", passive, service("hardware": Hardware))]
pub struct Yard {
    /// Where it notes what it does.
    #[property(required_text)]
    notes: String,
    /// True if it does not know what became of its last action.
    #[property(default = false)]
    forgets: bool,
    /// The newest action of each robot, or where it entered: what the hardware itself remembers.
    newest: BTreeMap<u32, Note>,
}

impl Yard {
    fn note(&mut self, robot: u32, what: &str) -> Result<(), Failure> {
        let note = add(Path::new(&self.notes), robot, what).map_err(|error| Failure::new(error.to_string()))?;
        self.newest.insert(robot, note);
        Ok(())
    }

    /// Where a robot is once its action is over.
    fn place(&self, robot: u32) -> Option<Block> {
        self.newest.get(&robot).map(Note::block)
    }
}

impl Component for Yard {
    type Properties = Own<Self>;

    fn initialize(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        self.newest = notes(Path::new(&self.notes)).into_iter().map(|note| (note.robot, note)).collect();
        Ok(())
    }
}

impl Hardware for Yard {
    fn enter(&mut self, _: &mut Context<'_>, robot: u32, _: String, block: Block) -> Result<Block, Failure> {
        if let Some(place) = self.place(robot) {
            return Ok(place);
        }
        self.note(robot, &format!("enters at {block}"))?;
        Ok(block)
    }

    fn area(&mut self, _: &mut Context<'_>) -> Result<Area, Failure> {
        Ok(Area::from(&Map::new(SIDE, SIDE)))
    }

    fn begin(&mut self, _: &mut Context<'_>, robot: u32, action: Action) -> Result<Progress, Failure> {
        self.note(robot, &action.to_string())?;
        Ok(Progress::Running)
    }

    fn poll(&mut self, _: &mut Context<'_>, robot: u32) -> Result<Progress, Failure> {
        Ok(if self.newest.get(&robot).is_none_or(Note::is_over) { Progress::Done } else { Progress::Running })
    }

    fn cancel(&mut self, _: &mut Context<'_>, _: u32) -> Result<(), Failure> {
        Ok(())
    }

    fn retire(&mut self, _: &mut Context<'_>, robot: u32) -> Result<Block, Failure> {
        self.place(robot).ok_or_else(|| "it has not entered".into())
    }

    fn is_on_floor(&mut self, _: &mut Context<'_>, robot: u32) -> Result<bool, Failure> {
        Ok(self.place(robot).is_some())
    }

    fn recall(&mut self, context: &mut Context<'_>, robot: u32, action: Action) -> Result<Option<Progress>, Failure> {
        if self.forgets {
            return Ok(None);
        }
        match self.newest.get(&robot) {
            Some(note) if note.what == action.to_string() => self.poll(context, robot).map(Some),
            _ => Ok(Some(Progress::Failed)),
        }
    }
}

saoms_api::plugin! {
    classes: [Yard],
}
