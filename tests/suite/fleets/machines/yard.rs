//! The hardware: robots on a floor that notes each action when it begins. A note is one line of a file: the time, the
//! robot, and the action as people say it.

use std::collections::BTreeMap;
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use saoms_api::{Class, Component, Context, Failure};
use saoms_components::grid::{Block, Map};
use saoms_components::hardware::{Action, Area, Hardware, Progress};

use super::{FOLDER, FORGETS};

const SIDE: u32 = 5;
/// Time that each action takes.
const TAKES: Duration = Duration::from_millis(14);

#[derive(Class)]
#[class(name = "test.Yard", passive, service("hardware": Hardware))]
pub(super) struct Yard {
    /// Where it notes; none for one that does not run.
    noted: Option<PathBuf>,
    forgets: bool,
    /// The newest action of each robot, or where it entered: what the hardware itself remembers.
    newest: BTreeMap<u32, Note>,
}

/// A line of the notes.
#[derive(Clone, Debug)]
struct Note {
    at: Duration,
    robot: u32,
    what: String,
}

fn now() -> Duration {
    SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap()
}

fn notes(path: &Path) -> Vec<Note> {
    let text = fs::read_to_string(path).unwrap_or_default();
    let note = |line: &str| {
        let mut parts = line.splitn(3, ' ');
        let at = Duration::from_nanos(parts.next()?.parse().ok()?);
        Some(Note { at, robot: parts.next()?.parse().ok()?, what: parts.next()?.to_owned() })
    };
    text.lines().map(|line| note(line).unwrap()).collect()
}

/// The block of a note, such as that of `move to (3,1)`.
fn block(what: &str) -> Block {
    what.rsplit(' ').next().unwrap().parse().unwrap()
}

/// The newest action of a robot, or where it entered.
fn newest(path: &Path, robot: u32) -> Option<Note> {
    notes(path).into_iter().rfind(|note| note.robot == robot)
}

fn is_over(note: &Note) -> bool {
    now() >= note.at + TAKES
}

impl Yard {
    fn note(&mut self, robot: u32, what: &str) -> Result<(), Failure> {
        let path = self.noted.as_deref().ok_or_else(|| Failure::new("this yard does not run"))?;
        let mut file = OpenOptions::new().create(true).append(true).open(path).unwrap();
        let at = now();
        file.write_all(format!("{} {robot} {what}\n", at.as_nanos()).as_bytes()).unwrap();
        self.newest.insert(robot, Note { at, robot, what: what.to_owned() });
        Ok(())
    }

    /// Where a robot is once its action is over.
    fn place(&self, robot: u32) -> Option<Block> {
        self.newest.get(&robot).map(|note| block(&note.what))
    }

    /// What a person sees who looks whether the action was done of which a robot asks; `None` while it goes on.
    pub(super) fn look(path: &Path, robot: &str, question: &str) -> Option<bool> {
        let newest = newest(path, robot.trim_start_matches("Robot").parse().unwrap());
        let Some(newest) = newest.filter(|note| question.contains(&format!("about to {}, ", note.what))) else {
            return Some(false);
        };
        is_over(&newest).then_some(true)
    }
}

impl Component for Yard {
    type Properties = ();

    fn initialize(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        self.noted = std::env::var_os(FOLDER).map(|folder| Path::new(&folder).join("noted"));
        let all = self.noted.as_deref().map(notes).unwrap_or_default();
        self.newest = all.into_iter().map(|note| (note.robot, note)).collect();
        self.forgets = std::env::var(FORGETS).as_deref() == Ok("true");
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
        Ok(if self.newest.get(&robot).is_none_or(is_over) { Progress::Done } else { Progress::Running })
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

/// Number of pieces that lie where they have to.
pub(super) fn deposits(path: &Path) -> u64 {
    notes(path).iter().filter(|note| note.what.starts_with("deposit")).count() as u64
}

/// Checks that no robot began anything during an action, each move led to a free block beside, and each piece was
/// collected and deposited once at most.
pub(super) fn check(path: &Path) {
    let all = notes(path);
    let shown = || all.iter().rev().take(40).rev().map(|note| format!("{note:?}\n")).collect::<String>();
    let mut places: BTreeMap<u32, (Block, Block, Duration)> = BTreeMap::new();
    let mut handled: BTreeMap<String, u32> = BTreeMap::new();
    for note in &all {
        let to = block(&note.what);
        for (other, (from, at, until)) in places.iter().filter(|(other, _)| **other != note.robot) {
            let leaves = note.at < *until && *from == to;
            assert!(*at != to && !leaves, "robot {} meets robot {other} at {to}: {}", note.robot, shown());
        }
        let from = match places.get(&note.robot) {
            None => to,
            Some((_, from, until)) => {
                assert!(note.at >= *until, "robot {} begins {:?} too early: {}", note.robot, note.what, shown());
                let is_move = note.what.starts_with("move");
                assert!(from.distance(to) <= 1 && (!is_move || *from != to), "{note:?} from {from}: {}", shown());
                *from
            }
        };
        places.insert(note.robot, (from, to, note.at + TAKES));
        if !note.what.starts_with("move") {
            let what = note.what.split(" at ").next().unwrap().to_owned();
            let times = handled.entry(format!("{what} {}", if what == "enters" { note.robot } else { 0 })).or_default();
            *times += 1;
            assert_eq!(*times, 1, "{note:?} twice: {}", shown());
        }
    }
}
