use proptest::prelude::*;

use super::{
    ExpressionError, ExpressionValue, boolean, inside, integer, is_name, names, parse, pattern, render, words,
};

fn lookup(name: &str) -> Result<ExpressionValue, ExpressionError> {
    match name {
        "index" => Ok(ExpressionValue::Integer(7)),
        "robots" => Ok(ExpressionValue::Integer(40)),
        "site" => Ok(ExpressionValue::Text("north".into())),
        "simulated" => Ok(ExpressionValue::Boolean(true)),
        _ => Err(ExpressionError::new(format!("no `{name}`"))),
    }
}

/// The value of an expression, or its fault with the bytes that it is in.
fn of(text: &str) -> String {
    let value = parse(text).and_then(|one| match integer(&one, &mut lookup) {
        Err(fault) if fault.problem.message.contains("expected a whole number") => {
            boolean(&one, &mut lookup).map(|value| value.to_string())
        }
        number => number.map(|number| number.to_string()),
    });
    value.unwrap_or_else(|fault| {
        let instead = fault.problem.instead.map_or_else(String::new, |instead| format!(" -> {instead}"));
        format!("[{}] {}{instead}", &text[fault.at], fault.problem.message)
    })
}

#[test]
fn numbers_are_calculated_as_people_do() {
    for (text, value) in [
        ("index * 2 + 1", "15"),
        ("1 + index * 2", "15"),
        ("2 * (index - 10)", "-6"),
        ("-index % 11", "4"),
        ("-7 / 2", "-4"),
        ("10 - 4 - 3", "3"),
        ("- -3", "3"),
        ("9223372036854775807 + 1", "[9223372036854775807 + 1] the number is too large: beyond 64 bits"),
        ("9223372036854775808", "[9223372036854775808] `9223372036854775808` is too large"),
        ("1 / (index - 7)", "[(index - 7)] division by zero: `index - 7` is 0"),
        ("1 % 0", "[0] division by zero"),
        ("1.5 * 2", "[1.5] `1.5` is not a whole number"),
        ("", "[] expected an expression"),
        ("2 *", "[*] expected a value after this"),
        ("* 2", "[*] expected a value before `*`"),
        ("(1 + 2", "[(] `(` has no closing `)`"),
        ("1 2", "[2] expected an operator before this"),
        ("index =< 2", "[=<] there is no `=<` -> <="),
        ("index => 2", "[=>] there is no `=>` -> >="),
        ("$index", "[$] write the property's name without `$` in an expression -> "),
        ("inedx + 1", "[inedx] no `inedx`"),
        ("2 * ( inedx )", "[inedx] no `inedx`"),
        ("(site ) + 1", "[(site )] found the text `north`, expected a whole number"),
        ("site + 1", "[site] found the text `north`, expected a whole number"),
    ] {
        assert_eq!(of(text), value, "{text}");
    }
}

#[test]
fn conditions_are_typed() {
    for (text, value) in [
        ("robots > 10 and site == 'north'", "true"),
        ("not simulated or robots <= 40 and true", "true"),
        ("not (simulated and site != \"south\")", "false"),
        ("index % 2 == 1", "true"),
        ("simulated == false", "false"),
        ("robots == 0 or 100 / robots == 2", "true"),
        ("robots != 0 and 1 / (robots - 40) > 3", "[(robots - 40)] division by zero: `robots - 40` is 0"),
        ("robots == 0 and 1 / (robots - 40) > 3", "false"),
        ("robots == 0 and site > 3", "[site] found the text `north`, expected a whole number"),
        ("site == 3", "[site == 3] the text `north` cannot be compared with the number 3"),
        ("robots = 3", "[=] there is no `=` -> =="),
        ("simulated && true", "[&&] there is no `&&` -> and"),
        ("1 < robots < 50", "[<] two comparisons in a row"),
        ("site", "[site] found the text `north`, expected a condition"),
        ("site == 'north", "['north] this text has no closing `'`"),
    ] {
        assert_eq!(of(text), value, "{text}");
    }
}

fn rendered(text: &str) -> String {
    render(text, &mut lookup).unwrap_or_else(|faults| {
        let shown = faults.iter().map(|fault| format!("[{}] {}", &text[fault.at.clone()], fault.problem.message));
        shown.collect::<Vec<_>>().join("; ")
    })
}

#[test]
fn texts_get_numbers_in_place_of_expressions() {
    for (text, value) in [
        ("Robot${index:03}", "Robot007"),
        ("at ${index}s luggage (${index % 5},1)", "at 7s luggage (2,1)"),
        ("${-index:04}", "-007"),
        ("$${index} costs $5 and $${$${x", "${index} costs $5 and ${${x"),
        ("$", "$"),
        ("${index", "[${index] `${` has no closing `}`"),
        ("${}", "[] expected an expression"),
        ("${index:3}", "[3] expected the number of digits after `:`, with a `0` before it"),
        ("${index:099}-${nix}", "[099] expected the number of digits after `:`, with a `0` before it; [nix] no `nix`"),
    ] {
        assert_eq!(rendered(text), value, "{text}");
    }
    assert_eq!(pattern("Robot${index:03}-${'}'}$${"), "Robot*-*${");
    assert_eq!(names("${index * row}"), ["index", "row"]);
}

#[test]
fn names_are_found_in_what_is_half_written_too() {
    let found = |text: &str| words(text).into_iter().map(|at| text[at].to_owned()).collect::<Vec<_>>();
    assert_eq!(found("not robots > 2*(größe_1 and 'north' == site) or true"), ["robots", "größe_1", "site"]);
    assert_eq!(found("robots > "), ["robots"]);
    assert_eq!(found("robots == 'nor and site"), ["robots"]);
    assert_eq!(found("$robots & 2x"), ["robots", "x"]);
    assert_eq!(found("index:03x"), ["index"]);
    let parts = |text: &str| inside(text).into_iter().map(|at| text[at].to_owned()).collect::<Vec<_>>();
    assert_eq!(parts("R${index:03}-${'}' == x}$${y} ${z"), ["index:03", "'}' == x", "z"]);
    assert_eq!(parts("${"), [""]);
    assert!(is_name("größe_1") && !is_name("1x") && !is_name("a-b") && !is_name("and") && !is_name(""));
}

/// A quarter of what threads have, so that no build comes near the end of it.
const STACK: usize = 512 * 1024;

#[test]
fn depth_is_a_fault_and_no_crash() {
    let deep = || {
        for text in ["(".repeat(100_000), "-".repeat(100_000), "not ".repeat(100_000), "1+".repeat(100_000)] {
            assert!(parse(&text).is_err());
        }
        let chain = |inner: String| format!("({inner}{})", "+1".repeat(90));
        assert!(parse(&(0..90).fold("1".to_owned(), |inner, _| chain(inner))).is_err());
        assert_eq!(of(&format!("{}1{}", "(".repeat(30), ")".repeat(30))), "1");
        assert_eq!(of(&vec!["1"; 201].join(" + ")), "201");
    };
    let thread = std::thread::Builder::new().stack_size(STACK).spawn(deep).unwrap();
    thread.join().unwrap();
}

/// Parts of expressions, so that many of them can be read.
const PIECES: [&str; 12] = ["robots", "site", "nobody", "(", ")", " ", "not ", "-", " + ", " == ", " and ", "'north'"];

proptest! {
    #[test]
    fn whatever_the_text_there_is_an_answer_in_it(text in "[a-z0-9 ${}:()'\"+*/%<>=!é-]{0,40}") {
        if let Err(fault) = parse(&text) {
            prop_assert!(text.get(fault.at).is_some());
        }
        for fault in render(&text, &mut lookup).err().unwrap_or_default() {
            prop_assert!(text.get(fault.at).is_some());
        }
        pattern(&text);
        for at in words(&text).into_iter().chain(inside(&text)) {
            prop_assert!(text.get(at).is_some());
        }
        // What can be read has the names that are found in it.
        if let Ok(expression) = parse(&text) {
            let known: Vec<_> = expression.names().into_iter().map(|(_, at)| at).collect();
            prop_assert_eq!(words(&text), known);
        }
        names(&text);
    }

    #[test]
    fn names_are_where_they_are_written(pieces in prop::collection::vec(prop::sample::select(PIECES.to_vec()), 0..9)) {
        let text = pieces.concat();
        if let Ok(expression) = parse(&text) {
            for (name, at) in expression.names() {
                prop_assert_eq!(&text[at], name, "{}", &text);
            }
            let known: Vec<_> = expression.names().into_iter().map(|(_, at)| at).collect();
            prop_assert_eq!(words(&text), known, "{}", &text);
        }
    }

    #[test]
    fn texts_without_expressions_stay(text in "[^$]{0,20}") {
        prop_assert_eq!(rendered(&text), text);
    }

    #[test]
    fn quotients_are_rounded_down(one in -1000i64..1000, other in (-50i64..50).prop_filter("a divisor", |other| *other != 0)) {
        let quotient: i64 = of(&format!("({one}) / ({other})")).parse().unwrap();
        let exact = one as f64 / other as f64;
        prop_assert_eq!(quotient, exact.floor() as i64);
    }

    #[test]
    fn sums_are_those_of_numbers(one in -1000i64..1000, other in 1i64..1000) {
        let text = format!("({one}) * {other} + ({one}) / {other} - ({one}) % {other}");
        let value = one * other + one.div_euclid(other) - one.rem_euclid(other);
        prop_assert_eq!(of(&text), value.to_string());
    }
}
