//! Browsers that showed a token: a form takes it, and a cookie stands for it from then on. The token itself is in no
//! browser, and a session ends with the run.

use std::collections::VecDeque;
use std::io;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use axum::Router;
use axum::extract::State;
use axum::http::header::{COOKIE, SET_COOKIE};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{AppendHeaders, IntoResponse, Redirect, Response};
use axum::routing::{get, post};

use super::access::{Access, Right};
use super::answer::Refusal;
use super::page;
use crate::token::{are_equal, chance};

/// The path of the form.
pub(super) const LOGIN: &str = "/login";
/// The most sessions; one more ends the oldest.
const MOST: usize = 256;

/// The sessions of browsers.
#[derive(Debug)]
pub(super) struct Sessions {
    /// The name of their cookie: servers at other ports of the machine share its cookies.
    cookie: String,
    open: Mutex<VecDeque<Session>>,
}

struct Session {
    id: String,
    right: Right,
}

impl std::fmt::Debug for Session {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Session").field("right", &self.right).finish_non_exhaustive()
    }
}

impl Sessions {
    /// Those of a server at this port.
    pub(super) fn at(port: u16) -> Sessions {
        Sessions { cookie: format!("saoms-{port}"), open: Mutex::default() }
    }

    fn lock(&self) -> MutexGuard<'_, VecDeque<Session>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The right of the session that a request names.
    pub(super) fn right(&self, headers: &HeaderMap) -> Option<Right> {
        let named: Vec<&str> = self.named(headers).collect();
        let open = self.lock();
        let is_named = |session: &&Session| named.iter().any(|id| are_equal(id.as_bytes(), session.id.as_bytes()));
        open.iter().find(is_named).map(|session| session.right)
    }

    /// The values of its cookie.
    fn named<'a>(&'a self, headers: &'a HeaderMap) -> impl Iterator<Item = &'a str> {
        let cookies = headers.get_all(COOKIE).iter().filter_map(|value| value.to_str().ok());
        let pairs = cookies.flat_map(|value| value.split(';')).filter_map(|pair| pair.trim().split_once('='));
        pairs.filter(|(name, _)| *name == self.cookie).map(|(_, id)| id)
    }

    /// Begins a session: the cookie for it.
    fn begin(&self, right: Right) -> io::Result<String> {
        let id = chance()?;
        let cookie = format!("{}={id}; Path=/; HttpOnly; SameSite=Strict", self.cookie);
        let mut open = self.lock();
        if open.len() == MOST {
            open.pop_front();
        }
        open.push_back(Session { id, right });
        Ok(cookie)
    }

    /// Ends the sessions that a request names: the cookie that removes theirs.
    fn end(&self, headers: &HeaderMap) -> String {
        let named: Vec<&str> = self.named(headers).collect();
        self.lock().retain(|session| !named.contains(&&*session.id));
        format!("{}=; Path=/; HttpOnly; SameSite=Strict; Max-Age=0", self.cookie)
    }
}

/// The routes for who has shown no token yet: the form, and what it looks like.
pub(super) fn router(access: &Arc<Access>) -> Router {
    let router = Router::new().route(LOGIN, get(page::login).post(log_in)).route("/logout", post(log_out));
    router.with_state(Arc::clone(access)).merge(page::assets())
}

/// Takes the token of the form.
async fn log_in(State(access): State<Arc<Access>>, body: String) -> Response {
    let Some(right) = token(&body).and_then(|token| access.right_of(&token)) else {
        access.counts.denied.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        return (StatusCode::UNAUTHORIZED, page::login_again()).into_response();
    };
    match access.sessions.begin(right) {
        Ok(cookie) => (AppendHeaders([(SET_COOKIE, cookie)]), Redirect::to("/")).into_response(),
        Err(error) => Refusal::internal(error).into_response(),
    }
}

async fn log_out(State(access): State<Arc<Access>>, headers: HeaderMap) -> Response {
    (AppendHeaders([(SET_COOKIE, access.sessions.end(&headers))]), Redirect::to(LOGIN)).into_response()
}

/// The token in the text of a form.
fn token(body: &str) -> Option<String> {
    let value = body.split('&').find_map(|pair| pair.strip_prefix("token="))?;
    let mut bytes = value.bytes();
    let mut token = Vec::new();
    while let Some(byte) = bytes.next() {
        token.push(match byte {
            b'+' => b' ',
            b'%' => {
                let digits = [bytes.next()?, bytes.next()?];
                u8::from_str_radix(std::str::from_utf8(&digits).ok()?, 16).ok()?
            }
            other => other,
        });
    }
    // It is copied from a file, with the end of its line.
    String::from_utf8(token).ok().map(|token| token.trim().to_owned())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use super::*;

    fn request(cookie: &str) -> HeaderMap {
        HeaderMap::from_iter([(COOKIE, cookie.parse().unwrap())])
    }

    #[test]
    fn a_token_is_read_from_a_form() {
        assert_eq!(token("token=0123456789abcdef").unwrap(), "0123456789abcdef");
        assert_eq!(token("a=b&token=%2b%26%3D%C3%A4%0D%0A&c=d").unwrap(), "+&=\u{e4}");
        for body in ["", "tok=1", "token=%", "token=%4", "token=%zz", "token=%ff"] {
            assert_eq!(token(body), None, "{body}");
        }
    }

    #[test]
    fn a_session_has_its_right_until_it_ends() {
        let sessions = Sessions::at(8080);
        let cookie = sessions.begin(Right::View).unwrap();
        let pair = cookie.split(';').next().unwrap();
        assert!(pair.starts_with("saoms-8080="));
        assert_eq!(sessions.right(&request(&format!("other=1; {pair}"))), Some(Right::View));
        assert_eq!(sessions.right(&request(&pair.replace("8080", "8081"))), None);
        assert_eq!(sessions.right(&request("saoms-8080=")), None);
        assert_eq!(sessions.right(&HeaderMap::new()), None);
        assert!(!format!("{sessions:?}").contains(pair.split_once('=').unwrap().1));
        assert!(sessions.end(&request(pair)).contains("Max-Age=0"));
        assert_eq!(sessions.right(&request(pair)), None);
    }

    #[test]
    fn one_session_too_many_ends_the_oldest() {
        let sessions = Sessions::at(1);
        let cookies: Vec<String> = (0..=MOST).map(|_| sessions.begin(Right::Control).unwrap()).collect();
        assert_eq!(sessions.right(&request(&cookies[0])), None);
        assert_eq!(sessions.right(&request(&cookies[1])), Some(Right::Control));
        assert_eq!(sessions.lock().len(), MOST);
    }
}
