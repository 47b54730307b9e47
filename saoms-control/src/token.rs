//! The secrets with which a client on the network shows what it may do.

use std::fmt;
use std::fs::{self, File, OpenOptions};
use std::hint::black_box;
use std::io::{self, ErrorKind, Read, Write};
use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

use crate::place::{OwnFile, in_own_folder, user};

/// Bytes of chance in a new token.
const CHANCE: usize = 32;
/// The least and the greatest length of a token.
const LENGTHS: (usize, usize) = (16, 1024);

/// A token. Its text is shown nowhere.
#[derive(Clone)]
pub struct Token(String);

/// The tokens of a fleet, one for each right.
#[derive(Debug)]
pub struct Tokens {
    /// With it, a client may do everything.
    pub control: TokenFile,
    /// With it, a client sees everything, and can order nothing.
    pub view: TokenFile,
}

impl Tokens {
    /// True if both are the same: who may view could control then.
    pub fn are_one(&self) -> bool {
        self.control.token.is(self.view.token.0.as_bytes())
    }
}

/// A token in a file that only the user can read. A file that was made for it is removed when this is dropped.
#[derive(Debug)]
pub struct TokenFile {
    pub(crate) token: Token,
    path: PathBuf,
    _own: Option<OwnFile>,
}

impl fmt::Debug for Token {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("Token(..)")
    }
}

impl Token {
    /// The token in a file: its text without the white space around it.
    ///
    /// # Errors
    /// The file cannot be read, others than its owner can read or change it, or it holds no token.
    pub fn read(path: &Path) -> io::Result<Token> {
        // A pipe without a writer must not hold the program up.
        let file = OpenOptions::new().read(true).custom_flags(libc::O_NONBLOCK | libc::O_CLOEXEC).open(path)?;
        let metadata = file.metadata()?;
        if !metadata.is_file() {
            return Err(io::Error::new(ErrorKind::InvalidInput, "it is not a regular file"));
        }
        if metadata.mode() & 0o077 != 0 || ![user(), 0].contains(&metadata.uid()) {
            let message = "other users could read the token: restrict the file with `chmod 600`";
            return Err(io::Error::new(ErrorKind::PermissionDenied, message));
        }
        let mut text = String::new();
        file.take(LENGTHS.1 as u64 + 64).read_to_string(&mut text)?;
        let text = text.trim();
        if !(LENGTHS.0..=LENGTHS.1).contains(&text.len()) || !text.bytes().all(|byte| byte.is_ascii_graphic()) {
            let (least, most) = LENGTHS;
            let message = format!("a token has {least} to {most} visible ASCII characters, without blanks");
            return Err(io::Error::new(ErrorKind::InvalidData, message));
        }
        Ok(Token(text.to_owned()))
    }

    /// A token that somebody else made, such as that of a service which is told of alerts. `None` if a header cannot
    /// hold it.
    pub fn of(text: &str) -> Option<Token> {
        let is_one = (1..=LENGTHS.1).contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_graphic());
        is_one.then(|| Token(text.to_owned()))
    }

    /// The value of `Authorization` that a client sends.
    pub(crate) fn authorization(&self) -> String {
        format!("Bearer {}", self.0)
    }

    /// True if a client sent this token. How long that takes tells nothing about its text.
    pub(crate) fn is_in(&self, authorization: &[u8]) -> bool {
        let Some((scheme, given)) = authorization.split_at_checked("Bearer ".len()) else { return false };
        scheme.eq_ignore_ascii_case(b"Bearer ") && self.is(given)
    }

    /// True if this is its text. How long that takes tells nothing about it.
    pub(crate) fn is(&self, text: &[u8]) -> bool {
        are_equal(text, self.0.as_bytes())
    }
}

/// A text that nobody can guess.
pub(crate) fn chance() -> io::Result<String> {
    let mut chance = [0_u8; CHANCE];
    File::open("/dev/urandom")?.read_exact(&mut chance)?;
    Ok(chance.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Compares all bytes, wherever the first difference is.
pub(crate) fn are_equal(one: &[u8], other: &[u8]) -> bool {
    // The optimizer must not leave the loop early.
    let difference = one.iter().zip(other).fold(0, |found, (one, other)| black_box(found | (one ^ other)));
    one.len() == other.len() && difference == 0
}

impl TokenFile {
    /// The token in a file of the user.
    ///
    /// # Errors
    /// As [`Token::read`].
    pub fn given(path: &Path) -> io::Result<TokenFile> {
        Ok(TokenFile { token: Token::read(path)?, path: path.to_owned(), _own: None })
    }

    /// A new token in a new file. That of a program that has ended is replaced.
    ///
    /// # Errors
    /// The folder belongs to somebody else, or the file cannot be written.
    pub fn create(path: &Path) -> io::Result<TokenFile> {
        in_own_folder(path)?;
        match fs::symlink_metadata(path) {
            Ok(file) if file.is_file() && file.uid() == user() => fs::remove_file(path)?,
            _ => {}
        }
        let mut file = OpenOptions::new().write(true).create_new(true).mode(0o600).open(path)?;
        let own = OwnFile::of(path)?;
        let token = Token(chance()?);
        writeln!(file, "{}", token.0)?;
        Ok(TokenFile { token, path: path.to_owned(), _own: Some(own) })
    }

    /// The path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use std::fs::Permissions;
    use std::os::unix::fs::PermissionsExt;

    use super::*;

    fn refusal(folder: &Path, text: &str, mode: u32) -> Option<String> {
        let path = folder.join("token");
        fs::write(&path, text).unwrap();
        fs::set_permissions(&path, Permissions::from_mode(mode)).unwrap();
        Token::read(&path).err().map(|error| error.to_string())
    }

    #[test]
    fn a_token_is_taken_from_a_file_of_the_user_alone() {
        let folder = tempfile::tempdir().unwrap();
        let refusal = |text, mode| refusal(folder.path(), text, mode);
        assert_eq!(refusal("0123456789abcdef\n", 0o600), None);
        assert_eq!(refusal("0123456789abcdef", 0o400), None);
        for mode in [0o640, 0o604, 0o620, 0o602, 0o777] {
            assert!(refusal("0123456789abcdef\n", mode).unwrap().contains("chmod 600"), "{mode:o}");
        }
        for text in ["", "short", "0123456789 abcdef", "0123456789abcde\u{e4}", &"x".repeat(1025)] {
            assert!(refusal(text, 0o600).unwrap().contains("16 to 1024"), "{text}");
        }
        assert!(Token::read(folder.path()).is_err());
        assert!(Token::read(&folder.path().join("missing")).is_err());
    }

    #[test]
    fn a_new_token_is_in_a_file_that_goes_with_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fleet.token");
        fs::write(&path, "left by a program that was killed").unwrap();
        let made = TokenFile::create(&path).unwrap();
        assert_eq!(fs::metadata(&path).unwrap().mode() & 0o777, 0o600);
        let token = Token::read(&path).unwrap();
        assert_eq!(token.0.len(), 2 * CHANCE);
        assert!(made.token.is_in(token.authorization().as_bytes()));
        assert!(!format!("{made:?}").contains(&token.0));
        let other = TokenFile::create(&folder.path().join("other.token")).unwrap();
        assert_ne!(other.token.0, token.0);
        drop(made);
        assert!(!path.exists());
        drop(TokenFile::given(other.path()).unwrap());
        assert!(other.path().exists(), "the file of a user stays");
    }

    #[test]
    fn no_other_text_is_the_token() {
        let token = Token("0123456789abcdef".to_owned());
        assert!(token.is_in(b"Bearer 0123456789abcdef"));
        assert!(token.is_in(b"bearer 0123456789abcdef"));
        for other in ["", "Bearer ", "Bearer 0123456789abcde", "Bearer 0123456789abcdef0", "Bearer 1123456789abcdef"] {
            assert!(!token.is_in(other.as_bytes()), "{other}");
        }
        assert!(!token.is_in(b"0123456789abcdef"));
        assert!(!token.is_in(b"Basic  0123456789abcdef"));
    }
}
