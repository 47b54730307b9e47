//! Effects outside of the program begin once it is committed that somebody wants them: a program that goes on after a
//! kill knows of each.

use std::fs::{self, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::thread::sleep;
use std::time::{Duration, Instant};

use saoms_api::extension::{ServiceEffects, submit};
use saoms_api::host::{Interface, Registration, cdr};
use saoms_api::{Class, Component, Context, Failure, Message, Saved, interface};
use saoms_core::schedule::RunningFleet;
use saoms_core::store::Store;
use saoms_lang::registry::Registry;

use crate::fleet::{Diary, assembly_of, real};

/// A machine outside of the program.
#[interface(name = "test.Rig")]
pub(crate) trait Rig {
    /// Begins a piece of work; true while it runs.
    fn begin(&mut self, context: &mut Context<'_>, piece: u64) -> Result<bool, Failure>;

    /// True while the last piece of work runs.
    fn poll(&mut self, context: &mut Context<'_>) -> Result<bool, Failure>;

    /// Stops the work.
    fn cancel(&mut self, context: &mut Context<'_>) -> Result<(), Failure>;
}

submit! {
    ServiceEffects {
        interface: <dyn Rig as Interface>::NAME,
        begin: 0,
        poll: 1,
        end: &[2],
        waiting: || cdr::encode(&true),
        failed: || cdr::encode(&false),
    }
}

/// Writes down what it begins, where no program takes it back.
#[derive(Class)]
#[class(name = "rig", passive, service("rig": Rig))]
struct Recorder {
    runs: bool,
}

impl Component for Recorder {
    type Properties = ();
}

fn log() -> PathBuf {
    Path::new(&std::env::var_os(FOLDER).unwrap()).join("begun")
}

impl Rig for Recorder {
    fn begin(&mut self, _: &mut Context<'_>, piece: u64) -> Result<bool, Failure> {
        let mut file = OpenOptions::new().create(true).append(true).open(log()).unwrap();
        writeln!(file, "{piece}").unwrap();
        self.runs = true;
        Ok(true)
    }

    fn poll(&mut self, _: &mut Context<'_>) -> Result<bool, Failure> {
        Ok(std::mem::take(&mut self.runs))
    }

    fn cancel(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        Ok(())
    }
}

#[derive(Clone, Debug, Default, Message)]
struct Work {
    piece: u64,
    runs: bool,
}

/// Has the rig do one piece after the other. What may have begun before a restart is not begun again.
#[derive(Class)]
#[class(name = "driver", periodic, saves)]
struct Driver {
    #[reference]
    rig: Option<RigReference>,
    work: Work,
}

impl Component for Driver {
    type Properties = ();

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        assert_eq!(context.goes_on(), context.goes_on_from_earlier_program());
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if context.execution() == 0 {
            context.info(format!("wants {} ({})", self.work.piece, self.work.runs));
        }
        let Some(rig) = &self.rig else { return Ok(()) };
        if self.work.runs {
            self.work.runs = rig.poll(context)?;
            return Ok(());
        }
        let piece = self.work.piece + 1;
        self.work = Work { piece, runs: rig.begin(context, piece)? };
        Ok(())
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(Saved::of(&self.work))
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.work = saved.read()?.unwrap_or_default();
        Ok(())
    }
}

/// The folder of a killed program; without it, this is no such program.
const FOLDER: &str = "SAOMS_TEST_EFFECTS";

/// The program that [`no_effect_is_unknown_after_a_kill`] kills.
#[test]
fn program_that_is_killed() {
    let Some(folder) = std::env::var_os(FOLDER) else { return };
    let mut registry = Registry::new();
    registry.add(Registration::of::<Recorder>()).unwrap();
    registry.add(Registration::of::<Driver>()).unwrap();
    let mut assembly = assembly_of("D driver period=1\nR rig", &registry);
    let wire = &mut assembly.components[0].references[0];
    wire.reference = "rig".to_owned();
    wire.interface = "test.Rig".to_owned();
    wire.targets = vec![saoms_lang::assembly::WireTarget { component: 1, service: "rig".to_owned() }];
    let diary = Arc::new(Diary::default());
    let store = Store::open(&Path::new(&folder).join("state")).unwrap();
    let fleet = RunningFleet::start_with(assembly, real(30_000), vec![diary.clone()], |handle| handle.use_store(store))
        .unwrap();
    let until = Instant::now() + Duration::from_secs(20);
    let mut printed = 0;
    while Instant::now() < until {
        let lines = diary.lines();
        lines.lines().skip(printed).for_each(|line| eprintln!("{line}"));
        printed = lines.lines().count();
        sleep(Duration::from_millis(1));
    }
    drop(fleet);
}

#[test]
fn no_effect_is_unknown_after_a_kill() {
    let folder = tempfile::tempdir().unwrap();
    let begun = || -> Vec<u64> {
        let text = fs::read_to_string(folder.path().join("begun")).unwrap_or_default();
        text.lines().map(|line| line.parse().unwrap()).collect()
    };
    for milliseconds in [60, 5, 75, 90, 61, 12, 80, 66, 94, 2, 72, 69, 85, 31, 47] {
        let before = begun();
        let mut program = Command::new(std::env::current_exe().unwrap());
        program.args(["--exact", "effects::program_that_is_killed", "--nocapture"]).env(FOLDER, folder.path());
        let mut program = program.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let mut lines = BufReader::new(program.stderr.take().unwrap()).lines().map_while(Result::ok);
        let wants = lines.find(|line| line.contains("wants ")).unwrap();
        let piece: u64 = wants.split("wants ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        let last = before.last().copied().unwrap_or_default();
        assert!(piece >= last, "it began {last}, and knows of {piece}");
        sleep(Duration::from_millis(milliseconds));
        program.kill().unwrap();
        program.wait().unwrap();
        let told: Vec<String> = lines.collect();
        assert!(!told.iter().any(|line| line.contains("begins anew") || line.contains("failed")), "{told:?}");
    }
    let all = begun();
    assert!(all.len() > 20, "{all:?}");
    assert!(all.windows(2).all(|pair| pair[0] < pair[1]), "each once: {all:?}");
}
