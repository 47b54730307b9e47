use super::{Curve, Lane, Mark, Panel, Timeline, slope, svg};

fn curve(points: &[(f64, f64)]) -> Curve {
    Curve { name: "a<b".to_owned(), points: points.to_vec(), is_filled: true }
}

#[test]
fn a_timeline_has_panels_lanes_and_guides() {
    let mark = Mark { from_s: 2.0, to_s: Some(4.0), text: "\"fire\" & <smoke>".to_owned() };
    let timeline = Timeline {
        title: "hall & yard".to_owned(),
        subtitle: "done\u{1b}[2J".to_owned(),
        end_s: 10.0,
        panels: vec![Panel { heading: "open".to_owned(), curves: vec![curve(&[(0.0, 0.0), (5.0, 2.0), (10.0, 2.0)])] }],
        lanes: vec![
            Lane { name: "fire".to_owned(), is_guide: true, marks: vec![mark.clone(), mark.clone()] },
            Lane { name: "a very long name that nobody can read".to_owned(), is_guide: false, marks: vec![mark] },
        ],
    };
    let drawn = svg(&timeline);
    for part in [
        "<title>hall &amp; yard</title>",
        "done\\u{1b}[2J",
        "a&lt;b",
        "&quot;fire&quot; &amp; &lt;smoke&gt;",
        "prefers-color-scheme:dark",
        "d=\"M190 172H563V90H936\"",
        "class=\"guide\"",
        "a very long name that nob\u{2026}",
    ] {
        assert!(drawn.contains(part), "{part}: {drawn}");
    }
    assert_eq!(drawn.matches("class=\"mark\"").count(), 2, "what lies on another mark is left out");
    assert!(!drawn.contains("<script"));
}

#[test]
fn what_is_not_known_is_a_gap_and_nothing_breaks_the_picture() {
    let points = [(0.0, f64::NAN), (1.0, 3.0), (2.0, f64::INFINITY), (3.0, 1.0)];
    let panel = Panel { heading: String::new(), curves: vec![curve(&points), curve(&[])] };
    for end_s in [4.0, 0.0, -1.0, f64::NAN, 1e300] {
        let mark = Mark { from_s: f64::NAN, to_s: Some(-5.0), text: String::new() };
        let lanes = vec![Lane { marks: vec![mark], is_guide: true, ..Lane::default() }; 40];
        let timeline = Timeline { end_s, panels: vec![panel.clone()], lanes, ..Timeline::default() };
        let drawn = svg(&timeline);
        assert!(drawn.contains("and 16 more") && !drawn.contains("NaN") && !drawn.contains("inf"), "{drawn}");
        assert!(end_s != 4.0 || drawn.matches("class=\"curve c").count() == 3, "{drawn}");
    }
}

#[test]
fn a_slope_needs_time() {
    assert_eq!(slope(&[(0.0, 1.0)], 0.0, 10), []);
    assert_eq!(slope(&[], 10.0, 1), [(0.0, 0.0), (10.0, 0.0)]);
    assert_eq!(slope(&[], 10.0, 0), []);
}
