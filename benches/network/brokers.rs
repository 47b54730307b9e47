//! Programs at other brokers: mosquitto over MQTT 3.1.1 at quality of service 0, and ActiveMQ over STOMP 1.2.

use std::io::{self, BufRead as _, BufReader, BufWriter, Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::{self, sleep};
use std::time::{Duration, Instant};

use super::components::{note, wall_clock};
use super::{MARGIN, Outcome, PERIOD, Part, Program};

/// Bytes of a message.
const SIZE: usize = 128;
/// Time for a broker to start.
const START: Duration = Duration::from_secs(20);

/// The words of a broker.
#[derive(Clone, Copy)]
pub(super) enum Wire {
    Mqtt,
    Stomp,
}

/// ActiveMQ with one connector and without a store, as a program.
const ACTIVE_MQ: &str = r#"
import org.apache.activemq.broker.BrokerService;
public class Broker {
    public static void main(String[] arguments) throws Exception {
        BrokerService broker = new BrokerService();
        broker.setPersistent(false);
        broker.setUseJmx(false);
        broker.addConnector("stomp://127.0.0.1:" + arguments[0]);
        broker.start();
        broker.waitUntilStopped();
    }
}
"#;

impl Wire {
    /// True if the broker is installed.
    pub(super) fn is_installed(self) -> bool {
        match self {
            Wire::Mqtt => Path::new("/usr/sbin/mosquitto").exists(),
            Wire::Stomp => Path::new("/usr/share/java/activemq-broker.jar").exists(),
        }
    }

    /// Starts the broker, and waits until it listens.
    pub(super) fn broker(self, port: u16) -> Outcome<Child> {
        let folder = std::env::temp_dir().join(format!("saoms-bench-broker-{port}"));
        std::fs::create_dir_all(&folder)?;
        let mut command = match self {
            Wire::Mqtt => {
                let file = folder.join("mosquitto.conf");
                std::fs::write(&file, format!("listener {port} 127.0.0.1\nallow_anonymous true\n"))?;
                let mut command = Command::new("/usr/sbin/mosquitto");
                command.arg("-c").arg(file);
                command
            }
            Wire::Stomp => {
                let file = folder.join("Broker.java");
                std::fs::write(&file, ACTIVE_MQ)?;
                let mut command = Command::new("java");
                command.args(["-cp", "/usr/share/java/*"]).arg(file).arg(port.to_string());
                command
            }
        };
        command.current_dir(folder).stdout(Stdio::null()).stderr(Stdio::null());
        let broker = command.spawn()?;
        let since = Instant::now();
        while TcpStream::connect(("127.0.0.1", port)).is_err() {
            if since.elapsed() > START {
                return Err("the broker does not start".into());
            }
            sleep(Duration::from_millis(50));
        }
        Ok(broker)
    }

    /// Runs a source or a sink.
    pub(super) fn run(self, program: &Program) -> Outcome<()> {
        let stream = TcpStream::connect(("127.0.0.1", program.port))?;
        stream.set_nodelay(true)?;
        let mut input = BufReader::with_capacity(1 << 16, stream.try_clone()?);
        let mut output = BufWriter::with_capacity(1 << 16, stream);
        self.greet(&mut input, &mut output)?;
        let seconds = Duration::from_secs(program.seconds.into());
        match program.part {
            Part::Router => return Err("the broker is a program of its own".into()),
            Part::Sink => {
                self.subscribe(&mut output)?;
                // What it waits for when the time is over never comes.
                thread::spawn(move || {
                    while let Ok(sent) = self.read(&mut input) {
                        note(sent.into_iter());
                    }
                });
                sleep(2 * MARGIN + seconds);
            }
            Part::Source { messages } => {
                sleep(MARGIN);
                let mut due = Instant::now();
                for _ in 0..program.seconds * 1_000 {
                    sleep(due.saturating_duration_since(Instant::now()));
                    due += PERIOD;
                    for _ in 0..messages {
                        self.publish(&mut output, wall_clock())?;
                    }
                    output.flush()?;
                }
                sleep(MARGIN / 2);
            }
        }
        Ok(())
    }

    fn greet(self, input: &mut BufReader<TcpStream>, output: &mut impl io::Write) -> io::Result<()> {
        match self {
            Wire::Mqtt => {
                let name = format!("bench{:06}", std::process::id());
                let length = u8::try_from(12 + name.len()).unwrap_or(u8::MAX);
                output.write_all(&[0x10, length, 0, 4])?;
                output.write_all(b"MQTT\x04\x02\x00\x3c")?;
                output.write_all(&[0, u8::try_from(name.len()).unwrap_or(u8::MAX)])?;
                output.write_all(name.as_bytes())?;
                output.flush()?;
                input.read_exact(&mut [0; 4])
            }
            Wire::Stomp => {
                output.write_all(b"CONNECT\naccept-version:1.2\nhost:localhost\n\n\0")?;
                output.flush()?;
                input.read_until(0, &mut Vec::new()).map(|_| ())
            }
        }
    }

    fn subscribe(self, output: &mut impl io::Write) -> io::Result<()> {
        match self {
            Wire::Mqtt => output.write_all(b"\x82\x0a\x00\x01\x00\x05bench\x00")?,
            Wire::Stomp => output.write_all(b"SUBSCRIBE\nid:0\ndestination:/topic/bench\n\n\0")?,
        }
        output.flush()
    }

    fn publish(self, output: &mut impl io::Write, sent: u64) -> io::Result<()> {
        let mut message = [7; SIZE];
        message[..8].copy_from_slice(&sent.to_le_bytes());
        match self {
            // 135 bytes follow: the topic and the message.
            Wire::Mqtt => output.write_all(b"\x30\x87\x01\x00\x05bench")?,
            Wire::Stomp => output.write_all(b"SEND\ndestination:/topic/bench\ncontent-length:128\n\n")?,
        }
        output.write_all(&message)?;
        if matches!(self, Wire::Stomp) { output.write_all(b"\0") } else { Ok(()) }
    }

    /// The time of sending of the next message; `None` for what is no message.
    fn read(self, input: &mut BufReader<TcpStream>) -> io::Result<Option<u64>> {
        let mut message = [0; SIZE];
        match self {
            Wire::Mqtt => {
                let mut kind = [0];
                input.read_exact(&mut kind)?;
                let (mut length, mut shift) = (0_usize, 0);
                loop {
                    let mut byte = [0];
                    input.read_exact(&mut byte)?;
                    length |= usize::from(byte[0] & 0x7f) << shift;
                    shift += 7;
                    if byte[0] < 0x80 {
                        break;
                    }
                }
                if kind[0] >> 4 != 3 {
                    io::copy(&mut input.take(length as u64), &mut io::sink())?;
                    return Ok(None);
                }
                input.read_exact(&mut [0; 7])?;
                input.read_exact(&mut message)?;
            }
            Wire::Stomp => {
                let mut line = Vec::new();
                loop {
                    line.clear();
                    if input.read_until(b'\n', &mut line)? == 0 {
                        return Err(io::ErrorKind::UnexpectedEof.into());
                    }
                    // An empty line ends the headers; those between two frames begin with none.
                    if line == b"MESSAGE\n" {
                        break;
                    }
                }
                while line != b"\n" {
                    line.clear();
                    input.read_until(b'\n', &mut line)?;
                }
                input.read_exact(&mut message)?;
                input.read_exact(&mut [0])?;
            }
        }
        Ok(message.first_chunk().map(|sent| u64::from_le_bytes(*sent)))
    }
}
