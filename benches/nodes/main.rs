//! What a robot of a fleet in several programs costs on the network, however large the fleet is. See
//! `benches/README.md`.

#![expect(clippy::print_stderr, reason = "the progress of a long measurement is for the person who waits for it")]

#[allow(dead_code, unused_imports, reason = "each benchmark uses a part")]
#[path = "../common/mod.rs"]
mod common;

use std::fmt::Write as _;
use std::fs;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use clap::Parser;
use serde::Serialize;
use serde_json::Value;

use common::{Outcome, cpu_time, memory, verdict};

/// Runs robots in ten programs, in as many zones, and counts the bytes through the router.
#[derive(Parser)]
#[command(name = "cargo bench --bench nodes --")]
struct Arguments {
    /// Numbers of robots, multiples of ten.
    #[arg(long, value_delimiter = ',', default_value = "100,300,1000")]
    robots: Vec<u32>,
    /// Seconds before the measured time, and in it.
    #[arg(long, default_value_t = 30)]
    warm_up: u64,
    #[arg(long, default_value_t = 30)]
    seconds: u64,
    /// The command, with the library of the transport beside it.
    #[arg(long, default_value = "target/release/saoms")]
    command: PathBuf,
    /// Flag that Cargo passes to every benchmark.
    #[arg(long, hide = true)]
    bench: bool,
}

/// Programs with robots, each with a zone: in rows of five.
const NODES: u32 = 10;
const IN_A_ROW: u32 = 5;
/// Blocks between the chargers of two neighbours.
const SPACING: u32 = 10;
/// Seconds from one wave of luggage to the next: a piece near each robot.
const WAVE: u64 = 30;
/// Greatest part of the bytes of a robot in the smallest fleet that one in a larger fleet may cost.
const GOAL: f64 = 1.1;

/// A fleet, measured.
#[derive(Serialize)]
struct Measured {
    robots: u32,
    /// Bytes in a second of each robot: from programs to the router, and from it to programs.
    to_router: f64,
    from_router: f64,
    cpu_cores: f64,
    executions: u64,
    missed: u64,
    delivered: u64,
    largest_mb: f64,
}

fn main() -> Outcome<()> {
    let arguments = Arguments::parse();
    if !arguments.bench {
        eprintln!("a benchmark is run with `cargo bench --bench nodes`");
        return Ok(());
    }
    let mut all = Vec::new();
    for robots in &arguments.robots {
        eprintln!("{robots} robots");
        all.push(measure(&arguments, (robots / NODES).max(1))?);
    }
    let mut page = format!("Robots in {NODES} programs, period 1 s. {}.\n\n", common::description());
    writeln!(
        page,
        "| robots | bytes/s each to the router | from it | executions | missed | delivered | CPU cores | MB of the largest | |"
    )?;
    writeln!(page, "| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |")?;
    for one in &all {
        let Measured { robots, to_router, from_router, executions, missed, delivered, cpu_cores, largest_mb } = one;
        let first = all.first().map_or(f64::NAN, |first| first.to_router + first.from_router);
        let part = (to_router + from_router) / first;
        writeln!(
            page,
            "| {robots} | {to_router:.0} | {from_router:.0} | {executions} | {missed} | {delivered} | {cpu_cores:.2} | \
             {largest_mb:.0} | {part:.2} of the first, goal {GOAL}: {} |",
            verdict(part <= GOAL && *missed == 0)
        )?;
    }
    common::write("nodes", &page, &all)
}

/// Programs that are killed with it.
struct Programs(Vec<Child>);

impl Drop for Programs {
    fn drop(&mut self) {
        for child in &mut self.0 {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// Runs a fleet with so many robots in each program.
fn measure(arguments: &Arguments, each: u32) -> Outcome<Measured> {
    let folder = Path::new(common::RESULTS).join("nodes").join((each * NODES).to_string());
    // Reports of an earlier run would be taken for those of a program that fails.
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    let port = TcpListener::bind("127.0.0.1:0")?.local_addr()?.port();
    let lasting = arguments.warm_up + arguments.seconds;
    fs::write(folder.join("fleet.composite"), composite(each, port, lasting))?;
    let command = fs::canonicalize(&arguments.command)?;
    let nodes: Vec<String> =
        ["hub".to_owned()].into_iter().chain((0..NODES).map(|node| format!("gate-{node}"))).collect();
    let (begin, mut programs) = (Instant::now(), Programs(Vec::new()));
    for node in &nodes {
        let mut program = Command::new(&command);
        program.current_dir(&folder).args(["run", "fleet.composite", "--node", node, "--control", "none"]);
        program.args(["--for", &format!("{}s", lasting + 15), "--report", &format!("{node}.json")]);
        let log = fs::File::create(folder.join(format!("{node}.log")))?;
        programs.0.push(program.stdout(log.try_clone()?).stderr(log).stdin(Stdio::null()).spawn()?);
    }
    sleep(Duration::from_secs(arguments.warm_up).saturating_sub(begin.elapsed()));
    let used = |programs: &Programs| -> Outcome<Duration> {
        Ok(programs.0.iter().map(|one| cpu_time(one.id())).sum::<Result<Duration, _>>()?)
    };
    let (at, before, cpu) = (Instant::now(), carried(port)?, used(&programs)?);
    sleep(Duration::from_secs(arguments.seconds));
    let (time, after, cpu) = (at.elapsed().as_secs_f64(), carried(port)?, used(&programs)? - cpu);
    let peaks: Vec<u64> = programs.0.iter().filter_map(|one| Some(memory(one.id()).ok()?.peak_kb)).collect();
    for (child, node) in programs.0.iter_mut().zip(&nodes) {
        child.wait()?;
        if !folder.join(format!("{node}.json")).exists() {
            return Err(format!("`{node}` has no report: see {}", folder.join(format!("{node}.log")).display()).into());
        }
    }
    let robots = each * NODES;
    let (mut executions, mut missed, mut delivered) = (0, 0, 0);
    for node in &nodes {
        let report: Value = serde_json::from_str(&fs::read_to_string(folder.join(format!("{node}.json")))?)?;
        for component in report["components"].as_array().into_iter().flatten() {
            executions += component["executions"].as_u64().unwrap_or_default();
            missed += component["missed"].as_u64().unwrap_or_default();
        }
        delivered += report["luggage"]["delivered"].as_u64().unwrap_or_default();
    }
    let lost = || "the bytes cannot be told: a connection to the router has ended meanwhile";
    let of_each = |before: u64, after: u64| -> Outcome<f64> {
        Ok(after.checked_sub(before).ok_or_else(lost)? as f64 / time / f64::from(robots))
    };
    Ok(Measured {
        robots,
        to_router: of_each(before.0, after.0)?,
        from_router: of_each(before.1, after.1)?,
        cpu_cores: cpu.as_secs_f64() / time,
        executions,
        missed,
        delivered,
        largest_mb: peaks.into_iter().max().unwrap_or_default() as f64 / 1e3,
    })
}

/// The bytes that the router has received and sent over all its connections, as `ss` counts them.
fn carried(port: u16) -> Outcome<(u64, u64)> {
    let filter = format!("( sport = :{port} )");
    let output = Command::new("ss").args(["-tinH", "state", "established", &filter]).output()?;
    if !output.status.success() || output.stdout.is_empty() {
        return Err(
            format!("`ss` shows no connection of the router: {}", String::from_utf8_lossy(&output.stderr)).into()
        );
    }
    let text = String::from_utf8(output.stdout)?;
    let sum = |name: &str| {
        let values = text.split_whitespace().filter_map(|word| word.strip_prefix(name)?.strip_prefix(':'));
        values.filter_map(|value| value.parse::<u64>().ok()).sum::<u64>()
    };
    Ok((sum("bytes_received"), sum("bytes_sent")))
}

/// The fleet: a hub with the broker and what happens, and programs with robots, the zone in which they work, and its
/// master.
fn composite(each: u32, port: u16, seconds: u64) -> String {
    let columns = (1..).find(|columns| columns * columns >= each).unwrap_or(1);
    let side = columns * SPACING;
    let (width, height) = (side * IN_A_ROW, side * NODES.div_ceil(IN_A_ROW));
    let row = ".".repeat(width as usize);
    let map = format!("{row}\n").repeat(height as usize);
    let corner = |node: u32| (node % IN_A_ROW * side, node / IN_A_ROW * side);
    let spot = |robot: u32| (robot % columns * SPACING + 4, robot / columns * SPACING + 4);
    let mut scenario = String::new();
    let mut components = String::new();
    for wave in 0..=seconds / WAVE {
        for (node, robot) in (0..NODES).flat_map(|node| (0..each).map(move |robot| (node, robot))) {
            let ((left, top), (x, y)) = (corner(node), spot(robot));
            let (x, y, at) = (left + x, top + y, 5 + wave * WAVE);
            // Writing to a string cannot fail.
            let _ = writeln!(scenario, "at {at}s luggage ({},{}) to ({},{})", x + 1, y + 2, x + 4, y + 3);
        }
    }
    let mut add = |node: &str, name: &str, class: &str, more: &[(&str, String)]| {
        let _ = writeln!(components, "  <component name=\"{name}\" saoms:node=\"{node}\">");
        let _ = writeln!(components, "    <implementation.java class=\"{class}\"/>");
        for (property, value) in more {
            let _ = writeln!(components, "    <property name=\"{property}\">{value}</property>");
        }
        let _ = writeln!(components, "  </component>");
    };
    let task = |name: &str, more: &[(&'static str, String)]| {
        let usual = [("ID", name.to_owned()), ("period", "1s".to_owned()), ("url", format!("127.0.0.1:{port}"))];
        usual.into_iter().chain(more.iter().cloned()).collect::<Vec<_>>()
    };
    let address = [("IP", "127.0.0.1".to_owned()), ("port", port.to_string())];
    add("hub", "Broker", "unibg.robotics.tca.MessageBrokerImpl", &address);
    add("hub", "Environment", "saoms.Environment", &task("Environment", &[("scenario", scenario)]));
    for node in 0..NODES {
        let (at, (left, top), number) = (format!("gate-{node}"), corner(node), (node + 1).to_string());
        let place = [("x", left), ("y", top), ("width", side), ("height", side)];
        let mut zone: Vec<(&str, String)> = place.iter().map(|(name, value)| (*name, value.to_string())).collect();
        zone.extend([("number", number.clone()), ("map", map.clone())]);
        let (name, master) = (format!("Zone{node}"), format!("Master{node}"));
        add(&at, &name, "saoms.Zone", &task(&name, &zone));
        let assignment = [("assignment", "optimal".to_owned()), ("zone", number), ("restart", "onFailure".to_owned())];
        add(&at, &master, "saoms.MasterEnvironment", &task(&master, &assignment));
        for robot in 0..each {
            let (name, (x, y)) = (format!("Robot{}", node * each + robot + 1), spot(robot));
            let delay = 1_000 * (node * each + robot) / (NODES * each);
            let own = [
                ("delay", format!("{delay}ms")),
                ("chargeX", (left + x).to_string()),
                ("chargeY", (top + y).to_string()),
                ("dischargePerBlock", "0.1".to_owned()),
                ("chargePerSecond", "10".to_owned()),
            ];
            add(&at, &name, "saoms.Robot", &task(&name, &own));
        }
    }
    format!(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:saoms=\"urn:saoms:1\" \
         targetNamespace=\"urn:nodes\" name=\"nodes\">\n{components}</composite>\n"
    )
}
