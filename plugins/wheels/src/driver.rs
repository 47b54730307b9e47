//! Connection to the controller: orders go out at once, answers come in on a thread of their own.

use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Time in which a connection is made, and in which the controller takes an order.
const PATIENCE: Duration = Duration::from_secs(2);
/// Longest line that counts as an answer, in bytes.
const LONGEST: u64 = 256;

/// Progress of the newest order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum OrderState {
    Running,
    #[default]
    Done,
    Failed,
}

/// A line for the controller.
enum Line {
    /// An order with its number.
    Order(u64, String),
    /// The driver is alive, and says so again within so many milliseconds.
    Alive(u64),
}

/// Driver of one controller, which threads share. It never waits, but in [`stop`](Driver::stop).
#[derive(Debug)]
pub(crate) struct Driver {
    lines: Sender<Line>,
    newest: Arc<Newest>,
}

impl Driver {
    /// Starts the threads; the connection is made with the first order.
    pub(crate) fn start(address: String) -> io::Result<Driver> {
        let (lines, received) = channel();
        let newest = Arc::<Newest>::default();
        let shared = Arc::clone(&newest);
        thread::Builder::new().name("wheels".to_owned()).spawn(move || send_lines(&address, &received, &shared))?;
        Ok(Driver { lines, newest })
    }

    /// Gives an order, whether or not the earlier one is answered: so `stop` overtakes a move. Returns its number.
    pub(crate) fn order(&self, what: &str) -> u64 {
        self.give(&mut self.newest.lock(), what, false)
    }

    /// Orders a stop, unless the newest order is one that has not failed: a controller that takes its time to confirm a
    /// stop is told once, however many want it. Returns its number.
    pub(crate) fn order_stop(&self) -> u64 {
        let mut newest = self.newest.lock();
        if newest.is_stop && newest.state != OrderState::Failed {
            return newest.number;
        }
        self.give(&mut newest, "stop", true)
    }

    /// Gives an order while the newest one is locked, so that numbers go out in their order.
    fn give(&self, newest: &mut Order, what: &str, is_stop: bool) -> u64 {
        let number = newest.number + 1;
        let sent = self.lines.send(Line::Order(number, format!("{number} {what}\n")));
        let state = if sent.is_ok() { OrderState::Running } else { OrderState::Failed };
        *newest = Order { number, state, is_stop };
        number
    }

    /// Tells the controller that the robot is alive; the next time is within `period`. Where the line before has not
    /// gone out yet, this one is left out: what is late says nothing.
    pub(crate) fn alive(&self, period: Duration) {
        if !self.newest.beats.swap(true, Ordering::SeqCst) {
            let milliseconds = u64::try_from(period.as_millis()).unwrap_or(u64::MAX).max(1);
            // An order after it would fail.
            let _ = self.lines.send(Line::Alive(milliseconds));
        }
    }

    /// State of the order with this number. It has failed if another order came after it, such as a stop from outside.
    pub(crate) fn state(&self, number: u64) -> OrderState {
        let newest = self.newest.lock();
        if newest.number == number { newest.state } else { OrderState::Failed }
    }

    /// Orders a stop and waits until it is confirmed; false if it is not. Without an order before there is nothing to
    /// stop.
    pub(crate) fn stop(&self, patience: Duration) -> bool {
        if self.newest.lock().number == 0 {
            return true;
        }
        let number = self.order_stop();
        let is_running = |order: &mut Order| order.number == number && order.state == OrderState::Running;
        let waited = self.newest.answered.wait_timeout_while(self.newest.lock(), patience, is_running);
        drop(waited.unwrap_or_else(PoisonError::into_inner));
        self.state(number) == OrderState::Done
    }
}

/// An order, by its number; 0 before the first one.
#[derive(Debug, Default)]
struct Order {
    number: u64,
    state: OrderState,
    is_stop: bool,
}

/// The newest order: answers to earlier ones do not count any more.
#[derive(Debug, Default)]
struct Newest {
    order: Mutex<Order>,
    answered: Condvar,
    /// True while a heartbeat waits to go out.
    beats: AtomicBool,
}

impl Newest {
    fn lock(&self) -> std::sync::MutexGuard<'_, Order> {
        self.order.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes in an answer, if it is about the newest order, and the first one.
    fn answer(&self, number: u64, state: OrderState) {
        let mut order = self.lock();
        if (order.number, order.state) == (number, OrderState::Running) {
            order.state = state;
            self.answered.notify_all();
        }
    }
}

/// Sends orders until the driver is dropped. A connection that ended is made anew for the next order. No order is sent
/// twice: one that may have reached the controller has failed, and the robot decides what comes next.
fn send_lines(address: &str, lines: &Receiver<Line>, newest: &Arc<Newest>) {
    let mut connection: Option<Connection> = None;
    for line in lines {
        connection = connection.filter(|connection| !connection.shared.has_ended.load(Ordering::SeqCst));
        let (number, line) = match line {
            Line::Order(number, line) => (number, line),
            Line::Alive(period) => {
                newest.beats.store(false, Ordering::SeqCst);
                connection = connection.filter(|open| open.write(&format!("alive {period}\n")).is_ok());
                continue;
            }
        };
        let sent = match connection.take().map_or_else(|| Connection::new(address, newest), Ok) {
            Ok(open) => connection.insert(open).send(number, &line),
            Err(error) => Err(error),
        };
        if sent.is_err() {
            connection = None;
            newest.answer(number, OrderState::Failed);
        }
    }
}

/// A connection. Its thread for answers ends with it.
struct Connection {
    stream: TcpStream,
    shared: Arc<ConnectionState>,
}

#[derive(Default)]
struct ConnectionState {
    newest_sent: AtomicU64,
    has_ended: AtomicBool,
}

impl Connection {
    fn new(address: &str, newest: &Arc<Newest>) -> io::Result<Connection> {
        let place = address.to_socket_addrs()?.next().ok_or(io::ErrorKind::AddrNotAvailable)?;
        let stream = TcpStream::connect_timeout(&place, PATIENCE)?;
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(PATIENCE))?;
        let (answers, newest) = (BufReader::new(stream.try_clone()?), Arc::clone(newest));
        let shared = Arc::<ConnectionState>::default();
        let of_thread = Arc::clone(&shared);
        thread::Builder::new().name("wheels answers".to_owned()).spawn(move || {
            take_answers(answers, &newest);
            of_thread.has_ended.store(true, Ordering::SeqCst);
            // What this connection has not answered, no other one will.
            newest.answer(of_thread.newest_sent.load(Ordering::SeqCst), OrderState::Failed);
        })?;
        Ok(Connection { stream, shared })
    }

    fn send(&mut self, number: u64, line: &str) -> io::Result<()> {
        // Before the order leaves: it may be answered before this thread goes on.
        self.shared.newest_sent.store(number, Ordering::SeqCst);
        if self.shared.has_ended.load(Ordering::SeqCst) {
            return Err(io::ErrorKind::ConnectionReset.into());
        }
        self.write(line)
    }

    fn write(&self, line: &str) -> io::Result<()> {
        (&self.stream).write_all(line.as_bytes())
    }
}

impl Drop for Connection {
    fn drop(&mut self) {
        // It is closed already if this fails.
        let _ = self.stream.shutdown(std::net::Shutdown::Both);
    }
}

/// Takes in lines such as `7 done` and `8 failed`, until the connection ends. Other lines are no answers.
fn take_answers(mut answers: BufReader<TcpStream>, newest: &Newest) {
    let mut line = Vec::new();
    while matches!(answers.by_ref().take(LONGEST).read_until(b'\n', &mut line), Ok(1..)) {
        let text = String::from_utf8_lossy(&line);
        if let Some((number, answer)) = text.trim().split_once(' ')
            && let Ok(number) = number.parse()
        {
            match answer {
                "done" => newest.answer(number, OrderState::Done),
                "failed" => newest.answer(number, OrderState::Failed),
                _ => {}
            }
        }
        line.clear();
    }
}
