//! State of an environment, for the one that takes its place after a failure.

use saoms_api::{Failure, Field, Message, Saved, Time};

use super::Environment;
use super::open_job::{KnownRobot, OpenJob};
use super::player::{Player, PlayerMemory};
use crate::validation::SpeakerMemory;

#[derive(Clone, Debug, Message)]
struct EnvironmentMemory {
    playing: Option<Playing>,
    played: u64,
    open: Vec<OpenPiece>,
    robots: Vec<RobotMemory>,
    luggage: u32,
    visits: u32,
    speakers: SpeakerMemory,
    has_world: bool,
    done: bool,
}

#[derive(Clone, Debug, Field)]
struct Playing {
    start: Time,
    player: PlayerMemory,
}

#[derive(Clone, Debug, Field)]
struct RobotMemory {
    robot: u32,
    known: KnownRobot,
}

#[derive(Clone, Debug, Field)]
struct OpenPiece {
    luggage: u32,
    job: OpenJob,
}

impl Environment {
    pub(super) fn save_state(&self) -> Saved {
        let open = self.open.iter().map(|(&luggage, job)| OpenPiece { luggage, job: job.clone() });
        let playing = self.playing.as_ref();
        Saved::of(&EnvironmentMemory {
            playing: playing.map(|(start, player)| Playing { start: *start, player: player.memory() }),
            played: self.played as u64,
            open: open.collect(),
            robots: self.robots_known.iter().map(|(&robot, &known)| RobotMemory { robot, known }).collect(),
            luggage: self.luggage,
            visits: self.visits,
            speakers: self.validator.memory(),
            has_world: self.has_world,
            done: self.done,
        })
    }

    /// Goes on from a saved state; the area comes again from its topic.
    pub(super) fn restore_state(&mut self, saved: &Saved) -> Result<(), Failure> {
        let Some(memory) = saved.read::<EnvironmentMemory>()? else { return Ok(()) };
        self.playing = match memory.playing {
            Some(Playing { start, player }) => Some((start, Player::of(&self.scenario, player)?)),
            None => None,
        };
        self.played = usize::try_from(memory.played).unwrap_or(usize::MAX);
        self.open = memory.open.into_iter().map(|piece| (piece.luggage, piece.job)).collect();
        self.robots_known = memory.robots.into_iter().map(|robot| (robot.robot, robot.known)).collect();
        (self.luggage, self.visits) = (memory.luggage, memory.visits);
        self.validator.restore(memory.speakers);
        (self.has_world, self.done) = (memory.has_world, memory.done);
        Ok(())
    }
}
