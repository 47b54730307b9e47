//! State of an environment, for the one that takes its place after a failure.

use saoms_api::{Failure, Field, Message, Saved, Time};

use super::player::{Player, PlayerMemory};
use super::{Environment, OpenJob};
use crate::validation::SpeakerMemory;

#[derive(Clone, Debug, Message)]
struct EnvironmentMemory {
    playing: Option<Playing>,
    played: u64,
    open: Vec<OpenPiece>,
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

#[derive(Clone, Copy, Debug, Field)]
struct OpenPiece {
    luggage: u32,
    passed_on: bool,
    is_visit: bool,
}

impl Environment {
    pub(super) fn save_state(&self) -> Saved {
        let open = self.open.iter().map(|(&luggage, &job)| {
            let OpenJob { passed_on, is_visit } = job;
            OpenPiece { luggage, passed_on, is_visit }
        });
        let playing = self.playing.as_ref();
        Saved::of(&EnvironmentMemory {
            playing: playing.map(|(start, player)| Playing { start: *start, player: player.memory() }),
            played: self.played as u64,
            open: open.collect(),
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
        let job = |piece: &OpenPiece| OpenJob { passed_on: piece.passed_on, is_visit: piece.is_visit };
        self.open = memory.open.iter().map(|piece| (piece.luggage, job(piece))).collect();
        (self.luggage, self.visits) = (memory.luggage, memory.visits);
        self.validator.restore(memory.speakers);
        (self.has_world, self.done) = (memory.has_world, memory.done);
        Ok(())
    }
}
