/// The look of a robot's path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    pub(super) colour: &'static str,
    /// The colour of letters on it.
    pub(super) on_colour: &'static str,
    /// Lengths of strokes and gaps, in widths of the line; empty for a whole line.
    pub(super) dash: &'static [f64],
}

/// Colours that people with any kind of colour vision can distinguish, without yellow, which is faint on white: M.
/// Okabe and K. Ito, "Color Universal Design" (2008).
const COLOURS: [(&str, &str); 7] = [
    ("#0072b2", "#fff"),
    ("#d55e00", "#fff"),
    ("#009e73", "#fff"),
    ("#cc79a7", "#000"),
    ("#000000", "#fff"),
    ("#e69f00", "#000"),
    ("#56b4e9", "#000"),
];

const DASHES: [&[f64]; 4] = [&[], &[4.0, 2.0], &[1.4, 1.6], &[7.0, 1.6, 1.4, 1.6]];

/// The number of looks. More robots than that cannot be distinguished as lines.
pub(super) const LOOKS: usize = COLOURS.len() * DASHES.len();

/// The look of the robot that comes at this place, from 0.
pub(super) fn look(place: usize) -> Look {
    let (colour, on_colour) = COLOURS[place % COLOURS.len()];
    Look { colour, on_colour, dash: DASHES[place / COLOURS.len() % DASHES.len()] }
}

/// Shades for how often a block was entered, from seldom to often: ColorBrewer's YlGnBu, which prints well and is safe
/// for any colour vision (C. Brewer and M. Harrower, 2003).
pub(super) const SHADES: [&str; 6] = ["#edf8b1", "#c7e9b4", "#7fcdbb", "#41b6c4", "#2c7fb8", "#253494"];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_robots_look_alike() {
        for one in 0..LOOKS {
            for other in 0..one {
                assert_ne!(look(one), look(other));
            }
        }
    }
}
