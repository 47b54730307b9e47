//! A robot that asks a zone for grants, and with some seeds enters a block that was not granted to it.

use saoms_api::{CallError, Class, Component, Context, Failure, Own, Publisher, Subscription};
use saoms_components::grid::Block;
use saoms_components::hardware::{Action, Hardware, HardwareReference, Progress};
use saoms_components::messages::{
    GRANT, GRANT_REQUEST, Grant, GrantRequest, POSITION, Position, ROBOT_LIST, RobotList, Standing, Step, TERRITORY,
    Territory, link,
};

use super::bad_execution;

/// Drives around a rectangle, or there and back where that has one row, as the robot in C does.
#[derive(Class)]
#[class(name = "test.Greedy", periodic, reference("world": Hardware))]
pub(crate) struct Greedy {
    #[property(speaker)]
    number: u32,
    #[property]
    left: i32,
    #[property]
    top: i32,
    #[property]
    right: i32,
    #[property]
    bottom: i32,
    /// The corner where it starts: 0 at the left and the top, 1 at the right, and so on.
    #[property]
    corner: u32,
    #[publishes(POSITION)]
    positions: Publisher<Position>,
    #[publishes(ROBOT_LIST)]
    states: Publisher<RobotList>,
    #[publishes(GRANT_REQUEST)]
    requests: Publisher<GrantRequest>,
    #[subscribes(TERRITORY)]
    territories: Subscription<Territory>,
    #[subscribes(GRANT)]
    grants: Subscription<Grant>,
    world: HardwareReference,
    /// The execution from which on it takes what it is not given.
    bad: Option<u64>,
    zone: Territory,
    block: Block,
    /// The block that it has begun to enter.
    next: Option<Block>,
    /// What it holds, once it is on the floor.
    held: Option<Vec<Step>>,
    received: u64,
    said: GrantRequest,
}

impl Greedy {
    /// The corner where it goes.
    fn goal(&self) -> Block {
        let x = if matches!(self.corner % 4, 1 | 2) { self.right } else { self.left };
        Block::new(x, if self.corner % 4 >= 2 { self.bottom } else { self.top })
    }

    /// Stands on the floor at its first corner. False while the world cannot be reached.
    fn enter(&mut self, context: &mut Context<'_>) -> Result<bool, Failure> {
        let start = self.goal();
        match self.world.enter(context, self.number, context.name().to_owned(), start) {
            Ok(block) => {
                self.block = block;
                self.held = Some(vec![Step { number: 0, block }]);
                Ok(true)
            }
            Err(CallError::Busy { .. } | CallError::NotRunning { .. }) => Ok(false),
            Err(error) => Err(error.into()),
        }
    }

    /// Takes in what its zone says.
    fn hear(&mut self, context: &Context<'_>) {
        if let Some(zone) = context.receive(&self.territories).next_back() {
            self.zone = zone.clone();
        }
        let held = self.held.get_or_insert_default();
        for grant in context.receive(&self.grants) {
            let is_own = grant.robot == self.number && grant.incarnation == self.said.incarnation;
            for step in grant.steps.iter().filter(|_| is_own) {
                if step.number <= self.received {
                    continue;
                }
                self.received = step.number;
                if held.last().is_some_and(|end| end.block.distance(step.block) == 1) {
                    held.push(*step);
                }
            }
        }
    }

    /// Drives on: into the next block that it holds, or into the one ahead where it is bad.
    fn drive(&mut self, context: &mut Context<'_>, is_bad: bool) -> Result<(), Failure> {
        if self.next.is_none() {
            let ahead = Block::new(
                self.block.x + (self.goal().x - self.block.x).signum(),
                if self.goal().x == self.block.x {
                    self.block.y + (self.goal().y - self.block.y).signum()
                } else {
                    self.block.y
                },
            );
            let held = self.held.iter().flatten().nth(1).map(|step| step.block);
            let Some(next) = held.or_else(|| (is_bad && ahead != self.block).then_some(ahead)) else { return Ok(()) };
            self.world.begin(context, self.number, Action::move_to(next))?;
            self.next = Some(next);
        }
        match (self.world.poll(context, self.number)?, self.next) {
            (Progress::Running, _) | (_, None) => {}
            (Progress::Done, Some(next)) => {
                (self.block, self.next) = (next, None);
                // It has left the blocks before this one, and none of them may be its own.
                let held = self.held.get_or_insert_default();
                let left = held.iter().position(|step| step.block == next).unwrap_or(held.len());
                held.drain(..left);
            }
            (Progress::Failed, Some(next)) => return Err(Failure::new(format!("cannot move to {next}"))),
        }
        Ok(())
    }

    /// Says what it holds and where it goes; once more in every second execution.
    fn ask(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let held = self.held.clone().unwrap_or_default();
        let end = held.last().map_or(self.block, |step| step.block);
        let request = GrantRequest {
            link: link(self.zone.zone, self.number),
            zone: self.zone.zone,
            term: self.zone.term,
            robot: self.number,
            incarnation: 1,
            number: self.said.number,
            at: self.zone.closest(self.block),
            block: self.block,
            end,
            received: self.received,
            // One that holds nothing has taken what was not its own, and stays there.
            goal: if held.is_empty() { end } else { self.goal() },
            held,
            charger: self.block,
            rank: (2 << 56) - u64::from(self.number),
            standing: Standing::MakesWay,
            ahead: 0,
        };
        if request != self.said {
            self.said = GrantRequest { number: request.number + 1, ..request };
        } else if context.execution() % 2 == 1 {
            return Ok(());
        }
        context.send(&self.requests, self.said.clone())
    }
}

impl Component for Greedy {
    type Properties = Own<Self>;

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.world = context.reference("world")?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let now = context.execution();
        if now == 0 {
            self.bad = bad_execution(context);
        }
        if self.held.is_none() && !self.enter(context)? {
            return Ok(());
        }
        self.hear(context);
        if self.block == self.goal() {
            self.corner += 1;
        }
        self.drive(context, self.bad.is_some_and(|bad| now >= bad))?;
        let (robot, block) = (self.number, self.block);
        let next = self.next.unwrap_or(block);
        context.send(&self.positions, Position { robot, block, next, wanted: next, ..Position::default() })?;
        let state = RobotList { robot, active: true, battery: 80.0, block, charger: block, ..RobotList::default() };
        context.send(&self.states, state)?;
        if self.zone.zone == 0 { Ok(()) } else { self.ask(context) }
    }
}
