//! A connection to a broker, with TLS or without: one thread reads it, others write.

use std::io::{self, Read, Write as _};
use std::net::{Shutdown, TcpStream};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use rustls::ClientConnection;

use crate::{Failure, Language, Settings, connect, tls};

/// Bytes that are encrypted at once: those of a record.
const RECORD: usize = 16 << 10;

/// A connection to a broker.
#[derive(Debug)]
pub struct Link {
    stream: TcpStream,
    tls: Option<Mutex<ClientConnection>>,
    /// Held while something is written: what is encrypted leaves in its order.
    writes: Mutex<()>,
}

/// The end of a connection that one thread reads.
#[derive(Debug)]
pub(crate) struct Incoming {
    link: Arc<Link>,
    /// What was read and is encrypted.
    sealed: Box<[u8]>,
    /// Where that begins and ends.
    begin: usize,
    end: usize,
}

/// A connection over which nothing was said yet.
pub(crate) struct Connected(TcpStream);

/// What cuts a connection, whoever waits for it.
pub(crate) struct Cut(TcpStream);

impl Cut {
    /// Ends the connection now.
    pub(crate) fn cut(&self) {
        let _ = self.0.shutdown(Shutdown::Both);
    }
}

impl Connected {
    /// What cuts it.
    pub(crate) fn cutter(&self) -> Result<Cut, Failure> {
        self.0.try_clone().map(Cut).map_err(Failure::unreachable)
    }

    /// Begins to speak; who does not answer for so long is given up.
    pub(crate) fn open<L: Language>(self, settings: &Settings, patience: Duration) -> Result<Arc<Link>, Failure> {
        let Connected(mut stream) = self;
        let limits = stream.set_read_timeout(Some(patience)).and_then(|()| stream.set_nodelay(true));
        limits.map_err(Failure::unreachable)?;
        let mut connection = None;
        if settings.is_tls::<L>() {
            let mut own = tls::connection(&settings.tls, settings.host())?;
            while own.is_handshaking() {
                own.complete_io(&mut stream).map_err(|error| broken::<L>(&error, settings, patience))?;
            }
            connection = Some(Mutex::new(own));
        }
        Ok(Arc::new(Link { stream, tls: connection, writes: Mutex::default() }))
    }
}

pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Link {
    /// Connects.
    pub(crate) fn connect(settings: &Settings) -> Result<Connected, Failure> {
        connect(settings.address()).map(Connected)
    }

    pub(crate) fn incoming(self: &Arc<Self>) -> Incoming {
        Incoming { link: Arc::clone(self), sealed: vec![0; 2 * RECORD].into(), begin: 0, end: 0 }
    }

    /// Gives the other end up if it says nothing for so long.
    pub(crate) fn set_patience(&self, patience: Duration) -> io::Result<()> {
        self.stream.set_read_timeout(Some(patience))
    }

    /// Writes all of this.
    ///
    /// # Errors
    /// The connection is broken.
    pub fn write_all(&self, bytes: &[u8]) -> io::Result<()> {
        let _order = lock(&self.writes);
        let Some(tls) = &self.tls else { return (&self.stream).write_all(bytes) };
        for chunk in bytes.chunks(RECORD) {
            let mut connection = lock(tls);
            connection.writer().write_all(chunk)?;
            let sealed = sealed(&mut connection)?;
            drop(connection);
            (&self.stream).write_all(&sealed)?;
        }
        Ok(())
    }

    /// Says that nothing more is written.
    pub(crate) fn end(&self) {
        if let Some(tls) = &self.tls {
            lock(tls).send_close_notify();
            let _ = self.write_sealed(tls);
        }
        let _ = self.stream.shutdown(Shutdown::Write);
    }

    /// Ends the connection now.
    pub(crate) fn cut(&self) {
        let _ = self.stream.shutdown(Shutdown::Both);
    }

    /// Writes what TLS itself has to say.
    fn write_sealed(&self, tls: &Mutex<ClientConnection>) -> io::Result<()> {
        let _order = lock(&self.writes);
        let sealed = sealed(&mut lock(tls))?;
        (&self.stream).write_all(&sealed)
    }
}

/// What waits to be written, encrypted.
fn sealed(connection: &mut ClientConnection) -> io::Result<Vec<u8>> {
    let mut sealed = Vec::new();
    while connection.wants_write() {
        connection.write_tls(&mut sealed)?;
    }
    Ok(sealed)
}

impl Read for Incoming {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        let Some(tls) = &self.link.tls else { return (&self.link.stream).read(to) };
        loop {
            let mut connection = lock(tls);
            match connection.reader().read(to) {
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                read => return read,
            }
            if self.begin < self.end {
                let mut rest = &self.sealed[self.begin..self.end];
                let read = connection.read_tls(&mut rest)?;
                self.begin += read;
                let processed = connection.process_new_packets();
                let has_to_say = connection.wants_write();
                drop(connection);
                if has_to_say {
                    // The reason, where it is an alert. What cannot be said is not worth more than the error.
                    let _ = self.link.write_sealed(tls);
                }
                processed.map_err(io::Error::other)?;
                continue;
            }
            // Nothing is locked while the other end is waited for.
            drop(connection);
            (self.begin, self.end) = (0, (&self.link.stream).read(&mut self.sealed)?);
            if self.end == 0 {
                return Ok(0);
            }
        }
    }
}

/// What a broken connection means that is about to begin, where the other end had so long to answer.
pub(crate) fn broken<L: Language>(error: &io::Error, settings: &Settings, patience: Duration) -> Failure {
    let without = format!("{}://{}", L::NAME.to_ascii_lowercase(), settings.address());
    let of_tls = error.get_ref().and_then(|inner| inner.downcast_ref::<rustls::Error>());
    if let Some(text) = of_tls.and_then(|error| tls::words(error, settings.host(), &without)) {
        return Failure::failed(text);
    }
    match error.kind() {
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut => Failure::unreachable(format!(
            "it does not answer as {} does within {patience:?}: another program may have this port, or it is about to \
             start",
            L::BROKER
        )),
        io::ErrorKind::UnexpectedEof | io::ErrorKind::ConnectionReset | io::ErrorKind::BrokenPipe => {
            Failure::unreachable(format!(
                "who listens there ends the connection: another program, or a broker with TLS for a `url` without \
                 (`{}://`), or one that starts",
                L::WITH_TLS
            ))
        }
        _ => Failure::unreachable(error),
    }
}
