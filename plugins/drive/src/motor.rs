use saoms_components::hardware::Action;

/// A motor that turns for some periods, unless it jams halfway.
#[derive(Debug, Default)]
pub(crate) struct Motor {
    running: Option<Running>,
    /// Number of moves that it started.
    moves: u32,
}

#[derive(Debug)]
struct Running {
    action: Action,
    /// Number of periods that are left.
    left: u32,
    /// Number of periods left at which it jams.
    jams_at: Option<u32>,
}

/// State of a motor after a period.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Turn {
    /// The motor is at rest.
    Rests,
    /// The motor turns.
    Goes,
    /// The motor jammed in this move, which has this number.
    Jams(Action, u32),
    /// The move is done.
    Through(Action),
}

impl Motor {
    /// Starts a move that takes `periods` periods.
    pub(crate) fn start(&mut self, action: Action, periods: u32, jams: impl FnOnce(u32) -> bool) {
        self.moves = self.moves.saturating_add(1);
        let jams_at = jams(self.moves).then_some(periods / 2);
        self.running = Some(Running { action, left: periods, jams_at });
    }

    /// Turns for a period.
    pub(crate) fn turn(&mut self) -> Turn {
        let Some(Running { action, left, jams_at }) = &mut self.running else { return Turn::Rests };
        *left -= 1;
        let (action, left, jams) = (*action, *left, *jams_at == Some(*left));
        if !jams && left > 0 {
            return Turn::Goes;
        }
        self.running = None;
        if jams { Turn::Jams(action, self.moves) } else { Turn::Through(action) }
    }

    /// Stops the motor.
    pub(crate) fn stop(&mut self) {
        self.running = None;
    }
}

#[cfg(test)]
mod tests {
    use saoms_components::grid::Block;

    use super::*;

    fn turns(periods: u32, jams: bool) -> Vec<Turn> {
        let mut motor = Motor::default();
        motor.start(Action::move_to(Block::new(1, 0)), periods, |_| jams);
        let turns = std::iter::from_fn(|| Some(motor.turn()).filter(|turn| *turn != Turn::Rests));
        turns.collect()
    }

    #[test]
    fn a_move_takes_its_periods_or_jams_halfway() {
        let action = Action::move_to(Block::new(1, 0));
        assert_eq!(turns(3, false), [Turn::Goes, Turn::Goes, Turn::Through(action)]);
        assert_eq!(turns(1, false), [Turn::Through(action)]);
        assert_eq!(turns(4, true), [Turn::Goes, Turn::Jams(action, 1)]);
        for periods in 1..20 {
            assert_eq!(turns(periods, true).last(), Some(&Turn::Jams(action, 1)), "{periods}");
        }
    }

    #[test]
    fn a_motor_that_is_stopped_rests() {
        let mut motor = Motor::default();
        motor.start(Action::default(), 5, |_| false);
        motor.stop();
        assert_eq!(motor.turn(), Turn::Rests);
    }
}
