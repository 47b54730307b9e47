//! The password of a user, from where libpq looks for it.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use postgres::Config;
use postgres::config::Host;

/// The password of PGPASSWORD, or that of the file of passwords; `None` if there is none, as some servers need none.
///
/// # Errors
/// Other users can read the file.
pub(super) fn of(config: &Config, user: &str) -> Result<Option<String>, String> {
    if let Ok(password) = std::env::var("PGPASSWORD") {
        return Ok(Some(password));
    }
    let named = std::env::var_os("PGPASSFILE").map(PathBuf::from);
    let Some(path) = named.or_else(|| Some(Path::new(&std::env::var_os("HOME")?).join(".pgpass"))) else {
        return Ok(None);
    };
    let Ok(found) = fs::metadata(&path) else { return Ok(None) };
    if !found.is_file() {
        return Ok(None);
    }
    let (shown, mode) = (path.display(), found.permissions().mode());
    if mode & 0o077 != 0 {
        return Err(format!("other users can read the passwords in `{shown}`: `chmod 600 {shown}`"));
    }
    let text = fs::read_to_string(&path).map_err(|error| format!("`{shown}` cannot be read: {error}"))?;
    let port = config.get_ports().first().copied().unwrap_or(5432).to_string();
    let host = match config.get_hosts().first() {
        Some(Host::Tcp(name)) => name.clone(),
        Some(Host::Unix(folder)) if folder == Path::new(super::SOCKETS) => "localhost".to_owned(),
        Some(Host::Unix(folder)) => folder.display().to_string(),
        None => config.get_hostaddrs().first().map(ToString::to_string).unwrap_or_default(),
    };
    let wanted = [host.as_str(), port.as_str(), config.get_dbname().unwrap_or_default(), user];
    Ok(text.lines().find_map(|line| password(line, wanted)))
}

/// The password of a line, if it is for host, port, database and user.
fn password(line: &str, wanted: [&str; 4]) -> Option<String> {
    if line.starts_with('#') {
        return None;
    }
    let mut fields = vec![String::new()];
    let mut characters = line.chars();
    while let Some(character) = characters.next() {
        let is_between = character == ':' && fields.len() < 5;
        let character = if character == '\\' { characters.next()? } else { character };
        match fields.last_mut() {
            Some(_) if is_between => fields.push(String::new()),
            Some(field) => field.push(character),
            None => return None,
        }
    }
    let (secret, rest) = fields.split_last()?;
    let is_meant = rest.len() == 4 && rest.iter().zip(wanted).all(|(field, wanted)| field == "*" || field == wanted);
    is_meant.then(|| secret.clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_passwords_is_for_some() {
        let wanted = ["server", "5432", "fleet", "ada"];
        for (line, expected) in [
            ("server:5432:fleet:ada:secret", Some("secret")),
            ("*:*:*:ada:a\\:b\\\\c", Some("a:b\\c")),
            ("*:*:*:*:with:colons", Some("with:colons")),
            ("*:*:*:eve:secret", None),
            ("# *:*:*:*:secret", None),
            ("server:5432", None),
        ] {
            assert_eq!(password(line, wanted).as_deref(), expected, "{line}");
        }
    }
}
