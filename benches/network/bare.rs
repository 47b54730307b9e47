//! Programs of bare Zenoh.

use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use zenoh::qos::CongestionControl;
use zenoh::{Config, Wait as _};

use super::components::{note, wall_clock};
use super::{MARGIN, Outcome, PERIOD, Part, Program};

/// Bytes of a message.
const SIZE: usize = 128;

/// Runs one of the three programs.
pub(super) fn run(program: &Program) -> Outcome<()> {
    let session = zenoh::open(config(program)?).wait().map_err(|error| error.to_string())?;
    let seconds = Duration::from_secs(program.seconds.into());
    match program.part {
        Part::Router => loop {
            sleep(seconds);
        },
        Part::Sink => {
            let time = |bytes: &[u8]| bytes.first_chunk().map_or(0, |sent| u64::from_le_bytes(*sent));
            let subscriber = session.declare_subscriber("bench").callback(move |sample| {
                note([time(&sample.payload().to_bytes())].into_iter());
            });
            let _subscriber = subscriber.wait().map_err(|error| error.to_string())?;
            sleep(2 * MARGIN + seconds);
        }
        Part::Source { messages } => {
            sleep(MARGIN);
            let mut due = Instant::now();
            let mut message = [7; SIZE];
            for _ in 0..program.seconds * 1_000 {
                sleep(due.saturating_duration_since(Instant::now()));
                due += PERIOD;
                for _ in 0..messages {
                    message[..8].copy_from_slice(&wall_clock().to_le_bytes());
                    let put = session.put("bench", message.as_slice()).congestion_control(CongestionControl::Block);
                    put.wait().map_err(|error| error.to_string())?;
                }
            }
            sleep(MARGIN / 2);
        }
    }
    session.close().wait().map_err(|error| error.to_string().into())
}

/// The configuration of the transport over Zenoh.
fn config(program: &Program) -> Outcome<Config> {
    let mut config = Config::default();
    let mut set = |key: &str, value: Value| {
        config.insert_json5(key, &value.to_string()).map_err(|error| format!("{key}: {error}"))
    };
    let listens = matches!(program.part, Part::Router);
    let (mode, here) = if listens { ("router", "listen") } else { ("client", "connect") };
    set("mode", json!(mode))?;
    set("listen/endpoints", json!([]))?;
    set(&format!("{here}/endpoints"), json!([format!("tcp/127.0.0.1:{}", program.port)]))?;
    set("scouting/multicast/enabled", json!(false))?;
    set("scouting/gossip/enabled", json!(false))?;
    Ok(config)
}
