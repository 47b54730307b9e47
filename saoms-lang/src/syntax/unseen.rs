//! Characters that nobody sees, and those that look like others: they come with text from web pages and documents.

/// True for a character of no width.
pub(crate) fn is_unseen(character: char) -> bool {
    matches!(
        character,
        '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{2064}'
            | '\u{2066}'..='\u{2069}' | '\u{feff}'
    )
}

/// The character that this one looks like; a blank for other kinds of blanks, and `None` for one that looks like no
/// other, or that nobody sees.
pub(crate) fn looks_like(character: char) -> Option<char> {
    /// Letters of the Cyrillic and Greek alphabets, each before the Latin letter that it looks like.
    const LETTERS: &str = "аaеeоoрpсcуyхxіiјjѕsһhԁdԛqԝwАAВBЕEКKМMНHОOРPСCТTХXІIЈJЅS\
        ΑAΒBΕEΖZΗHΙIΚKΜMΝNΟOΡPΤTΥYΧXοoνvαa";
    match character {
        _ if character.is_ascii() => None,
        '\u{a0}' | '\u{1680}' | '\u{2000}'..='\u{200a}' | '\u{202f}' | '\u{205f}' | '\u{3000}' => Some(' '),
        '\u{2010}'..='\u{2015}' | '\u{2212}' => Some('-'),
        '\u{2018}'..='\u{201b}' => Some('\''),
        '\u{201c}'..='\u{201f}' => Some('"'),
        '\u{2044}' | '\u{2215}' => Some('/'),
        // The full width of ASCII.
        '\u{ff01}'..='\u{ff5e}' => char::from_u32(u32::from(character) - 0xff01 + 0x21),
        _ => {
            let pairs = LETTERS.chars().zip(LETTERS.chars().skip(1)).step_by(2);
            pairs.into_iter().find(|(letter, _)| *letter == character).map(|(_, latin)| latin)
        }
    }
}

/// What a name has in it that nobody sees, or that looks like something else: the name as it seems to be, and the
/// character. `None` for a name that is what it seems to be.
pub(crate) fn hidden_in(name: &str) -> Option<(String, String)> {
    let is_hidden = |sign: &char| is_unseen(*sign) || looks_like(*sign).is_some();
    let is_other = |sign: char| !sign.is_ascii() && !is_hidden(&sign);
    let first = name.chars().find(is_hidden).filter(|_| !name.contains(is_other))?;
    let seen = name.chars().filter(|sign| !is_unseen(*sign));
    Some((seen.map(|sign| looks_like(sign).unwrap_or(sign)).collect(), named(first)))
}

/// A hidden character by its number, with what is to be seen in its place.
pub(crate) fn named(character: char) -> String {
    let kind = match looks_like(character) {
        None => "which nobody sees".to_owned(),
        Some(' ') => "which looks like a blank".to_owned(),
        Some(meant) => format!("which looks like `{meant}`"),
    };
    format!("U+{:04X}, {kind}", u32::from(character))
}
