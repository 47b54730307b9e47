//! Connections of clients: how many, and for how long one may leave the server waiting.

use std::future::{Future, poll_fn};
use std::io::{self, ErrorKind};
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::task::{Context, Poll};
use std::time::Duration;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, UnixListener};
use tokio::sync::Semaphore;
use tokio::time::{Sleep, sleep, timeout};

use crate::counts::ClientCounts;

/// The most connections at each place; further ones are refused.
const MOST: usize = 512;
/// The most clients at a time that are told why they are refused; further ones are just closed.
const MOST_GOODBYES: usize = 32;
/// Time for the head of a request, also of the next one on a connection that stays.
const HEAD: Duration = Duration::from_secs(10);
/// Time for which a client may take nothing of its answer.
const TAKING: Duration = Duration::from_secs(10);
/// The most bytes of the head of a request, and of what is read ahead.
const BUFFER: usize = 16_384;
/// The most headers of a request.
const HEADERS: usize = 64;
/// Time after which a connection is tried again that the system could not give.
const AGAIN: Duration = Duration::from_millis(100);
/// Time for a client that is refused to take that.
const GOODBYE: Duration = Duration::from_millis(200);
const FULL: &[u8] = b"HTTP/1.1 503 Service Unavailable\r\nContent-Type: application/json\r\nConnection: close\r\n\
    Content-Length: 42\r\n\r\n{\"error\": \"the server has no more places\"}";

/// A place at which clients connect.
pub(super) trait Door: Send + 'static {
    type Stream: AsyncRead + AsyncWrite + Send + Unpin + 'static;

    fn accept(&self) -> impl Future<Output = io::Result<Self::Stream>> + Send;
}

impl Door for UnixListener {
    type Stream = tokio::net::UnixStream;

    async fn accept(&self) -> io::Result<Self::Stream> {
        UnixListener::accept(self).await.map(|(stream, _)| stream)
    }
}

impl Door for TcpListener {
    type Stream = tokio::net::TcpStream;

    async fn accept(&self) -> io::Result<Self::Stream> {
        let (stream, _) = TcpListener::accept(self).await?;
        // An event is one small write.
        stream.set_nodelay(true)?;
        Ok(stream)
    }
}

/// Serves who connects, for ever.
pub(super) async fn serve<D: Door>(door: D, router: Router, counts: Arc<ClientCounts>) {
    let (places, goodbyes) = (Arc::new(Semaphore::new(MOST)), Arc::new(Semaphore::new(MOST_GOODBYES)));
    loop {
        let stream = match door.accept().await {
            Ok(stream) => stream,
            // The client has gone.
            Err(error) if matches!(error.kind(), ErrorKind::ConnectionAborted | ErrorKind::ConnectionReset) => continue,
            // There are too many open files, say.
            Err(_) => {
                sleep(AGAIN).await;
                continue;
            }
        };
        let Ok(place) = Arc::clone(&places).try_acquire_owned() else {
            counts.refused.fetch_add(1, Ordering::Relaxed);
            if let Ok(place) = Arc::clone(&goodbyes).try_acquire_owned() {
                tokio::spawn(async move {
                    let _ = timeout(GOODBYE, refuse(stream)).await;
                    drop(place);
                });
            }
            continue;
        };
        let (router, counts) = (router.clone(), Arc::clone(&counts));
        tokio::spawn(async move {
            counts.open.fetch_add(1, Ordering::Relaxed);
            let patient = Patient { stream, counts: Arc::clone(&counts), until: None };
            let mut http = http1::Builder::new();
            http.timer(TokioTimer::new()).header_read_timeout(HEAD).max_buf_size(BUFFER).max_headers(HEADERS);
            // An error is one of the client.
            let _ = http.serve_connection(TokioIo::new(patient), TowerToHyperService::new(router)).await;
            counts.open.fetch_sub(1, Ordering::Relaxed);
            drop(place);
        });
    }
}

/// Says that there is no place. What the client has sent is read, since it would lose the answer otherwise.
async fn refuse(mut stream: impl AsyncRead + AsyncWrite + Unpin) -> io::Result<()> {
    // There is room for it in the empty buffer of a connection.
    poll_fn(|context| Pin::new(&mut stream).poll_write(context, FULL)).await?;
    poll_fn(|context| Pin::new(&mut stream).poll_shutdown(context)).await?;
    let mut ignored = [0; 1024];
    loop {
        let mut buffer = ReadBuf::new(&mut ignored);
        poll_fn(|context| Pin::new(&mut stream).poll_read(context, &mut buffer)).await?;
        if buffer.filled().is_empty() {
            return Ok(());
        }
    }
}

/// A connection that ends when its client takes nothing for too long.
struct Patient<S> {
    stream: S,
    counts: Arc<ClientCounts>,
    /// Set while the client takes nothing.
    until: Option<Pin<Box<Sleep>>>,
}

impl<S> Patient<S> {
    /// The result of writing, or of the time being over.
    fn limited<T>(&mut self, context: &mut Context<'_>, written: Poll<io::Result<T>>) -> Poll<io::Result<T>> {
        if written.is_ready() {
            self.until = None;
            return written;
        }
        let until = self.until.get_or_insert_with(|| Box::pin(sleep(TAKING)));
        if until.as_mut().poll(context).is_pending() {
            return Poll::Pending;
        }
        self.until = None;
        self.counts.dropped.fetch_add(1, Ordering::Relaxed);
        Poll::Ready(Err(ErrorKind::TimedOut.into()))
    }
}

impl<S: AsyncRead + Unpin> AsyncRead for Patient<S> {
    fn poll_read(mut self: Pin<&mut Self>, context: &mut Context<'_>, into: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_read(context, into)
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for Patient<S> {
    fn poll_write(mut self: Pin<&mut Self>, context: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write(context, bytes);
        self.limited(context, written)
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        let flushed = Pin::new(&mut self.stream).poll_flush(context);
        self.limited(context, flushed)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(context)
    }
}
