//! The components of a changing airport that count what they do, and fail where a test plants that.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::sleep;
use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure, Message, Publisher, Saved, Topic, Work, interface};
use saoms_core::schedule::ChangeWithdrawal;

#[derive(Clone, Debug, Default, Message)]
struct Level {
    level: u32,
    executions: u32,
}

const LEVELS: Topic<Level> = Topic::state("LEVELS");

/// Says what level is asked for.
#[interface(name = "test.Desk")]
trait Desk {
    /// A number that grows with each call.
    fn ask(&mut self, context: &mut Context<'_>) -> Result<u32, Failure>;
}

/// A desk.
#[derive(Class)]
#[class(name = "test.DeskImpl", passive, saves, service("desk": Desk))]
struct DeskImpl {
    asked: u32,
}

impl Component for DeskImpl {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(DeskImpl { asked: 0 })
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(Saved::of(&Level { level: 0, executions: self.asked }))
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.asked = saved.read::<Level>()?.unwrap_or_default().executions;
        Ok(())
    }
}

impl Desk for DeskImpl {
    fn ask(&mut self, _: &mut Context<'_>) -> Result<u32, Failure> {
        self.asked += 1;
        Ok(self.asked)
    }
}

/// How a planted failure happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum How {
    /// The code returns an error.
    Fails,
    /// The code does not return while the change waits for it.
    Hangs,
    /// Whoever asked for the change takes it back while the code runs, which does what it should.
    Withdraws,
}

/// How the failure that is planted now happens, and the way to take back the change that is made.
static PLANTED: Mutex<Option<(How, ChangeWithdrawal)>> = Mutex::new(None);
/// Number of failures that were planted or removed so far.
static TIMES: AtomicU64 = AtomicU64::new(0);

/// Plants a failure, or removes it: code that hangs goes on.
pub(super) fn plant(planted: Option<(How, ChangeWithdrawal)>) {
    *PLANTED.lock().unwrap() = planted;
    TIMES.fetch_add(1, Ordering::SeqCst);
}

fn planted() -> Option<(How, ChangeWithdrawal)> {
    PLANTED.lock().unwrap().clone()
}

/// Counts its executions, and fails where it is asked to.
#[derive(Class)]
#[class(name = "test.Gauge", periodic, saves)]
struct Gauge {
    /// What it says.
    #[property(default = 0, live)]
    level: u32,
    /// Another one makes another gauge of it.
    #[property(default = 0)]
    size: u32,
    /// Where it fails while a failure is planted: `initialize`, `restore`, `save`, `level`, `leaving` or `shutdown`.
    #[property(default = "")]
    fails: String,
    /// True if it is to leave.
    #[property(default = false, live)]
    leaving: bool,
    #[reference("desk")]
    desk: Option<DeskReference>,
    #[publishes(LEVELS)]
    levels: Publisher<Level>,
    executions: u32,
}

impl Gauge {
    fn fails_at(&self, what: &str) -> Result<(), Failure> {
        let Some((how, withdrawal)) = planted().filter(|_| self.fails == what) else { return Ok(()) };
        match how {
            How::Fails => return Err(Failure::new(format!("planted at {what}"))),
            How::Withdraws => withdrawal.withdraw(),
            How::Hangs => {
                let times = TIMES.load(Ordering::SeqCst);
                while TIMES.load(Ordering::SeqCst) == times {
                    sleep(Duration::from_millis(1));
                }
            }
        }
        Ok(())
    }
}

impl Component for Gauge {
    type Properties = saoms_api::Own<Self>;

    fn initialize(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        self.fails_at("initialize")
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.executions += 1;
        if self.leaving {
            context.vote(Work::Done);
        }
        if let Some(desk) = &self.desk {
            desk.ask(context)?;
        }
        context.send(&self.levels, Level { level: self.level, executions: self.executions })
    }

    fn update(&mut self, properties: Self::Properties) -> Result<(), Failure> {
        if properties.level != self.level {
            self.fails_at("level")?;
        }
        if properties.leaving {
            self.fails_at("leaving")?;
        }
        (self.level, self.leaving) = (properties.level, properties.leaving);
        Ok(())
    }

    fn shutdown(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        self.fails_at("shutdown")
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        self.fails_at("save")?;
        Ok(Saved::of(&Level { level: self.level, executions: self.executions }))
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.fails_at("restore")?;
        self.executions = saved.read::<Level>()?.unwrap_or_default().executions;
        Ok(())
    }
}

/// Counts, and keeps nothing.
#[derive(Class)]
#[class(name = "test.Plain", periodic)]
struct Plain {
    /// Another one makes another one of it.
    #[property(default = 0)]
    size: u32,
    executions: u32,
}

impl Component for Plain {
    type Properties = saoms_api::Own<Self>;

    fn execute(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        self.executions += self.size.min(1);
        Ok(())
    }
}
