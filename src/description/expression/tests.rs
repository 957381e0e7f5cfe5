//! Tests: values of expressions, messages of wrong ones, and that no text makes the reader panic.

use proptest::prelude::{Just, ProptestConfig, Strategy, any, prop_oneof};

use super::*;
use crate::bounds::Bounds;
use crate::expression::syntax::{Binary, FUNCTIONS, Function, OPERATORS, RESERVED};
use crate::expression::token::{continues_name, starts_name};
use crate::feature_value::{FeatureValue, FromScalar};
use crate::words::RoadSurface;

fn road(name: &str) -> Option<Scalar> {
    let text = |text: &str| Some(Scalar::Text(text.into()));
    match name {
        "highway" => text("primary"),
        "lanes" => text("2"),
        "width" => text("narrow"),
        "maxheight" => text("12'6\""),
        "building:levels" => text("3"),
        "name" => text("Queen's Road"),
        "odd name" => Some(Scalar::Number(7.0)),
        "bridge" => text("viaduct"),
        "oneway" => Some(Scalar::Bool(true)),
        "depth" => Some(Scalar::Number(-2.5)),
        "tunnel" => text("no"),
        _ => None,
    }
}

fn value(text: &str) -> Option<Scalar> {
    Expression::parse(text).unwrap_or_else(|error| panic!("{text}: {error}")).value(&road)
}

fn number(text: &str) -> Option<f64> {
    match value(text) {
        Some(Scalar::Number(number)) => Some(number),
        None => None,
        other => panic!("{text} gives {other:?}"),
    }
}

fn holds(text: &str) -> bool {
    Expression::parse(text).unwrap_or_else(|error| panic!("{text}: {error}")).holds(&road)
}

#[test]
fn arithmetic_binds_as_in_school_and_reads_texts_as_numbers() {
    for (text, wanted) in [
        ("1 + 2 * 3", 7.0),
        ("(1 + 2) * 3", 9.0),
        ("10 - 4 - 3", 3.0),
        ("2 * -3", -6.0),
        ("--2", 2.0),
        ("lanes * 3.25", 6.5),
        ("building:levels * 3 + 1", 10.0),
        ("`odd name` / 2", 3.5),
        ("\"odd name\" + 1", 8.0),
        ("property('odd name') - 1", 6.0),
        ("1e3 + .5", 1000.5),
        ("min(3, lanes, 5)", 2.0),
        ("max(3, lanes)", 3.0),
        ("clamp(lanes, 3, 9)", 3.0),
        ("clamp(12, 3, 9)", 9.0),
        ("round(lanes * 1.25)", 3.0),
        ("number(lanes)", 2.0),
        ("if(lanes >= 2, 8, 4)", 8.0),
        ("match(highway, 'motorway', 20, 'primary', 10, 5)", 10.0),
        ("match(surface, 'gravel', 1, 2)", 2.0),
    ] {
        assert_eq!(number(text), Some(wanted), "{text}");
    }
}

#[test]
fn what_is_missing_stays_missing_until_a_fallback() {
    for text in [
        "speed",
        "speed + 1",
        "width * 2",
        "-speed",
        "1 / 0",
        "0 / 0",
        "1e300 * 1e300",
        "min(1, speed)",
        "clamp(speed, 1, 2)",
        "round(width)",
        "number(highway)",
        "match(highway, 'motorway', 1, 'trunk', 2)",
        "speed = 3",
        "speed < 3",
        "speed in (1, 2)",
        "highway < 3",
    ] {
        assert_eq!(value(text), None, "{text}");
    }
    assert_eq!(number("speed ?? 50"), Some(50.0));
    assert_eq!(number("1 / 0 ?? 4"), Some(4.0));
    assert_eq!(number("speed ?? lanes * 3 ?? 1"), Some(6.0));
    assert_eq!(number("(width ?? lanes) * 2"), Some(4.0), "narrow is no number where one is needed");
    assert_eq!(value("width ?? lanes"), Some(Scalar::Text("narrow".into())), "any value will do");
    assert!(holds("has(lanes) and not has(speed)"));
}

#[test]
fn a_fallback_is_taken_for_what_the_key_cannot_use() {
    fn computed<T: FromScalar>(text: &str, limits: T::Limits) -> Option<T> {
        let expression = Expression::parse(text).expect("an expression");
        FeatureValue::Computed { expression, limits, key: "[[road]] width".into() }.value(&road)
    }
    let quantity = computed::<f64>;
    let width = Bounds::Above(0.0, 100.0);
    assert_eq!(quantity("width ?? 6", width), Some(6.0));
    assert_eq!(quantity("depth ?? 6", width), Some(6.0), "−2.5 lies outside");
    assert_eq!(quantity("if(true, width ?? 5, 1)", width), Some(5.0));
    assert_eq!(quantity("width", width), None);
    assert_eq!(quantity("maxheight", width), Some(12.5 * 0.3048));
    let choice = |text: &str| computed::<RoadSurface>(text, ());
    assert_eq!(choice("highway ?? 'gravel'"), Some(RoadSurface::Gravel), "primary is no surface");
    assert_eq!(choice("if(lanes > 1, 'asphalt', 'track')"), Some(RoadSurface::Asphalt));
    assert_eq!(choice("highway"), None);
}

#[test]
fn comparisons_compare_numbers_as_numbers_and_texts_as_texts() {
    for text in [
        "highway = 'primary'",
        "highway != 'secondary'",
        "lanes = 2",
        "lanes >= 2 and lanes < 3",
        "lanes < '10'",
        "name = 'Queen''s Road'",
        "'a' < 'b'",
        "highway in ('trunk', 'primary')",
        "lanes in (1, 2)",
        "highway not in ('trunk')",
        "oneway = true",
        "oneway",
        "bridge = true",
        "tunnel = false",
        "not tunnel",
        "not speed",
        "not speed = 3",
        "speed = 3 or lanes = 2",
        "lanes ?? 1 >= 2",
    ] {
        assert!(holds(text), "{text}");
    }
    for text in [
        "highway = 'Primary'",
        "lanes = '2.0'",
        "tunnel",
        "speed",
        "not lanes",
        "speed != 3",
        "oneway = false",
    ] {
        assert!(!holds(text), "{text}");
    }
}

#[test]
fn a_text_is_a_number_plain_in_meters_or_in_feet() {
    let number = |text: &str| Scalar::Text(text.into()).number();
    for (text, wanted) in
        [("4.5", 4.5), (" 4.5 m ", 4.5), ("4m", 4.0), ("10 ft", 3.048), ("10'", 3.048), ("10'6\"", 3.2004)]
    {
        let found = number(text).unwrap_or_else(|| panic!("{text}"));
        assert!((found - wanted).abs() < 1e-12, "{text}: {found}");
    }
    for text in ["", "m", "wide", "4,5", "inf", "nan", "1e999", "10'12\"", "10'6", "5 km", "'", "4 5"] {
        assert_eq!(number(text), None, "{text}");
    }
    assert_eq!(Scalar::Bool(true).number(), None);
    assert_eq!(Scalar::Number(f64::NAN).number(), None);
}

#[test]
fn what_is_wrong_is_told_with_its_column_and_a_remedy() {
    for (text, column, message, help) in [
        ("lanes * ", 9, "expected a number, a text or a property, but found the end", "property"),
        ("lanes 3", 7, "expected the end or an operator, but found `3`", "operator"),
        ("(lanes", 7, "expected `)`", "close"),
        ("ronud(lanes)", 1, "there is no function `ronud`", "did you mean `round`?"),
        ("frobnicate(1)", 1, "there is no function", "the functions are `if`"),
        ("if(a, b)", 1, "`if` cannot have 2 arguments", "if(condition, then, else)"),
        ("a == 1", 3, "\"==\" means nothing", "write = "),
        ("a <> 1", 3, "\"<>\" means nothing", "write != "),
        ("a && b", 3, "\"&\" means nothing", "`and`"),
        ("名 = 'x", 5, "this ' is not closed", "close it"),
        ("a < b < c", 7, "comparisons cannot be chained", "a < b and b < c"),
        ("1.2.3", 1, "\"1.2.3\" is not a number", "1.5"),
        ("``", 1, "names no property", "between"),
        ("property(surface)", 10, "a property's name in quotes", "property('its name')"),
        ("and", 1, "expected a number", "property"),
        ("", 1, "but found the end", "property"),
    ] {
        let error = Expression::parse(text).expect_err(text);
        assert_eq!(error.column, Some(column), "{text}: {error}");
        assert!(error.message.contains(message), "{text}: {error}");
        assert!(error.help.contains(help), "{text}: {}", error.help);
        assert!(error.to_string().ends_with(&format!("at column {column}")), "{error}");
    }
}

#[test]
fn where_a_word_is_wanted_stray_words_are_told() {
    let words = ["asphalt", "gravel", "track"];
    let refused = |text: &str| Expression::parse_among(text, &words).expect_err(text);
    let bare = refused("if(lanes > 1, asphalt, 'gravel')");
    assert!(bare.message.contains("must be in quotes") && bare.column == Some(15), "{bare}");
    let stray = refused("surface ?? 'gravle'");
    assert!(stray.message.contains("cannot be \"gravle\"") && stray.help.contains("`gravel`"), "{stray:?}");
    assert!(Expression::parse_among("match(surface, 'dirt', 'track', 'asphalt')", &words).is_ok());
    assert!(Expression::parse_among("`gravel` ?? 'gravel'", &words).is_ok());
}

#[test]
fn long_and_deep_texts_are_refused_not_suffered() {
    let deep = |text: String| Expression::parse(&text).expect_err("too deep").message;
    assert!(deep(format!("{}1{}", "(".repeat(2000), ")".repeat(2000))).contains("nested"));
    assert!(deep(format!("{}1", "-".repeat(4000))).contains("nested"));
    assert!(deep(format!("{}1", "not ".repeat(1000))).contains("nested"));
    assert!(deep(vec!["1"; 1500].join("+")).contains("nested"));
    assert!(deep("1".repeat(5000)).contains("5000 bytes"));
    assert!(Expression::parse(&vec!["a"; 150].join(" or ")).is_ok());
    assert!(Expression::parse(&format!("x in ({})", vec!["1"; 1000].join(","))).is_ok());
}

#[test]
fn the_properties_that_it_looks_at_are_known() {
    let expression = Expression::parse("lanes * 3 ?? `a b` ?? if(lanes in (x), 1, y)").expect("sound");
    assert_eq!(expression.properties(), ["a b", "lanes", "x", "y"]);
}

/// How tightly comparisons and negations bind, as operators by their row in [`OPERATORS`], and all that is taken as
/// one.
const NEGATION: usize = 2;
const COMPARISON: usize = 3;
const NEGATIVE: usize = 7;
const SINGLE: usize = 8;

/// How tightly a node binds: the row of its operator, past negations.
fn strength(node: &ExpressionNode) -> usize {
    match node {
        ExpressionNode::Literal(_) | ExpressionNode::Property(_) | ExpressionNode::Call(..) => SINGLE,
        ExpressionNode::Negative(_) => NEGATIVE,
        ExpressionNode::Not(_) => NEGATION,
        ExpressionNode::In(..) => COMPARISON,
        ExpressionNode::Binary(binary, ..) => {
            let row = OPERATORS.iter().position(|row| row.iter().any(|operator| operator.1 == *binary));
            row.map_or(SINGLE, |row| row + usize::from(row > 1))
        }
    }
}

/// A text that reads as `node`, in brackets where it binds less than `least`.
fn written(node: &ExpressionNode, least: usize) -> String {
    let list = |list: &[ExpressionNode]| {
        format!("({})", list.iter().map(|part| written(part, 0)).collect::<Vec<_>>().join(", "))
    };
    let is_bare = |name: &str| {
        let mut letters = name.chars();
        letters.next().is_some_and(starts_name) && letters.all(continues_name) && !RESERVED.contains(&name)
    };
    let text = match node {
        ExpressionNode::Literal(Scalar::Bool(value)) => value.to_string(),
        ExpressionNode::Literal(Scalar::Number(number)) => number.to_string(),
        ExpressionNode::Literal(Scalar::Text(text)) => format!("'{}'", text.replace('\'', "''")),
        ExpressionNode::Property(name) if is_bare(name) => name.clone(),
        ExpressionNode::Property(name) => format!("`{}`", name.replace('`', "``")),
        ExpressionNode::Negative(of) => format!("-{}", written(of, NEGATIVE)),
        ExpressionNode::Not(of) => format!("not {}", written(of, NEGATION)),
        ExpressionNode::Binary(binary, left, right) => {
            let (sign, _) =
                OPERATORS.iter().copied().flatten().find(|known| known.1 == *binary).expect("listed");
            let own = strength(node);
            let left_least = if own == COMPARISON { own + 1 } else { own };
            format!("{} {sign} {}", written(left, left_least), written(right, own + 1))
        }
        ExpressionNode::In(of, of_these) => format!("{} in {}", written(of, COMPARISON + 1), list(of_these)),
        ExpressionNode::Call(function, parts) => {
            let (name, ..) = FUNCTIONS.iter().find(|known| known.1 == *function).expect("listed");
            format!("{name}{}", list(parts))
        }
    };
    if strength(node) < least { format!("({text})") } else { text }
}

/// Any tree that the grammar can write.
fn trees() -> impl Strategy<Value = ExpressionNode> {
    let leaf = prop_oneof![
        any::<bool>().prop_map(|value| ExpressionNode::Literal(Scalar::Bool(value))),
        (0.0..1e6).prop_map(|value| ExpressionNode::Literal(Scalar::Number(value))),
        "[a-z' `\"é-]{0,6}".prop_map(|text| ExpressionNode::Literal(Scalar::Text(text))),
        "[a-z:_ `\"'é-]{1,6}".prop_map(ExpressionNode::Property),
        Just(ExpressionNode::Property("and".into())),
    ];
    let binaries: Vec<Binary> = OPERATORS.iter().copied().flatten().map(|operator| operator.1).collect();
    leaf.prop_recursive(4, 40, 4, move |inner| {
        let some = proptest::collection::vec(inner.clone(), 1..4);
        let pair = (proptest::sample::select(binaries.clone()), inner.clone(), inner.clone());
        let functions: Vec<Function> = FUNCTIONS.iter().map(|known| known.1).collect();
        let calls = (proptest::sample::select(functions), proptest::collection::vec(inner.clone(), 3..6));
        prop_oneof![
            inner.clone().prop_map(|of| ExpressionNode::Negative(Box::new(of))),
            inner.clone().prop_map(|of| ExpressionNode::Not(Box::new(of))),
            pair.prop_map(|(join, left, right)| ExpressionNode::Binary(
                join,
                Box::new(left),
                Box::new(right)
            )),
            (inner, some).prop_map(|(of, list)| ExpressionNode::In(Box::new(of), list)),
            calls.prop_map(|(function, mut parts)| {
                let most = FUNCTIONS.iter().find(|known| known.1 == function).map_or(0, |known| known.3);
                parts.truncate(most);
                ExpressionNode::Call(function, parts)
            }),
        ]
    })
}

proptest::proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_is_written_reads_as_the_same(root in trees()) {
        let expression = Expression { root };
        let text = written(&expression.root, 0);
        let again = Expression::parse(&text);
        proptest::prop_assert_eq!(again.as_ref(), Ok(&expression), "{}", text);
    }

    #[test]
    fn no_text_breaks_the_reader_and_nothing_read_breaks_the_evaluation(
        bytes in proptest::collection::vec(any::<u8>(), 0..80)
    ) {
        let text = String::from_utf8_lossy(&bytes);
        match Expression::parse(&text) {
            Ok(expression) => drop(expression.value(&road)),
            Err(error) => {
                proptest::prop_assert!(text.get(error.at.clone()).is_some(), "{:?} in {:?}", error.at, text);
                proptest::prop_assert!(!error.help.is_empty());
            }
        }
    }

    #[test]
    fn no_row_of_tokens_breaks_it_either(
        parts in proptest::collection::vec(proptest::sample::select(vec![
            "lanes", "(", ")", ",", "+", "-", "*", "/", "=", "!=", "<", ">=", "and", "or", "not", "in", "??", "1", "0",
            "'a'", "`b`", "if", "match(", "min(", "clamp(", "round(", "has(", "property(", "true", "1e300", "name",
        ]), 0..24)
    ) {
        let text = parts.join(" ");
        if let Ok(expression) = Expression::parse(&text) {
            let value = expression.value(&road);
            if let Some(Scalar::Number(number)) = value {
                proptest::prop_assert!(number.is_finite());
            }
            let again = Expression::parse(&written(&expression.root, 0));
            proptest::prop_assert_eq!(again, Ok(expression));
        }
    }
}
