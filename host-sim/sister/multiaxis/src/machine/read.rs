//! A machine file, `M.toml`: keys, ranges and errors.
//!
//! ```toml
//! version = 1
//! kind = "table-table"                # table-table | table-head | head-head
//! coordinates = "joints"              # what X, Y, Z are: "joints" (default) or "tip"
//! pole_deg = 5.0                      # optional: nearer to the pole a move is singular
//! orientation_tolerance_deg = 0.5     # optional: of the tool axis, from the great circle
//!
//! [[rotary]]                          # the axis that carries the other comes first
//! axis = "A"
//! on = "table"                        # needed with table-head only
//! point_mm = [0.0, 0.0, -20.0]        # a point of its line; default the origin
//! turns = "right-hand"                # or "left-hand" (ISO 841 tables)
//! limits_deg = [-110.0, 30.0]         # optional
//!
//! [[rotary]]
//! axis = "C"
//!
//! [tool]                              # optional
//! length_mm = 120.0                   # gauge point to tip; matters with a head
//! ball_radius_mm = 3.0                # a ball end
//! helix_deg = 30.0                    # of its edge
//! counts = "tip"                      # or "centre": the point whose chord error counts
//!
//! [travel]                            # optional
//! x_mm = [-300.0, 300.0]
//! ```
//!
//! Errors carry the codes of all TOML files, J002 to J010, and point at the value.

use std::cell::RefCell;

use toml::Spanned;
use toml::de::DeValue;
use truepath_ground::codes::J008;
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::{InputError, Source};
use truepath_ground::document::{Section, Spans, Value};
use truepath_ground::limits::Limits;
use truepath_ground::notation;

use super::{Coordinates, Counted, Kind, Letter, Machine, MachineError, Rotary, Sense, Side, Tool};

const LENGTH: fn() -> Limits = || Limits::within("-100000", "100000", "mm");

impl Machine {
    /// Reads and checks a machine file.
    ///
    /// # Errors
    /// An [`InputError`] at the first thing that is wrong.
    pub fn from_toml(source: &Source) -> Result<Self, InputError> {
        let table = notation::parse(source, "the machine file")?;
        let spans = RefCell::new(Spans::new());
        let root = Section::root(source, &table, &spans);
        notation::version(source, &root)?;
        let kinds = [("table-table", Kind::TableTable), ("table-head", Kind::TableHead), ("head-head", Kind::HeadHead)];
        let Some(kind) = root.choice("kind", &kinds)? else {
            return Err(root.missing("kind", "one of table-table, table-head, head-head"));
        };
        let coordinates = [("joints", Coordinates::Joints), ("tip", Coordinates::Tip)];
        let coordinates = root.choice("coordinates", &coordinates)?.unwrap_or(Coordinates::Joints);
        let angle = |key, limits| Ok::<_, InputError>(root.number(key, limits)?.map(|n| n.as_f64().to_radians()));
        let pole = angle("pole_deg", Limits::within("0", "45", "degrees"))?;
        let orientation = angle("orientation_tolerance_deg", Limits::within("0.001", "90", "degrees"))?;
        let sections = root.sections("rotary")?;
        let [first, second] = &sections[..] else {
            return Err(two_axes(source, &root, sections.len()));
        };
        let sides = match kind {
            Kind::TableTable => [Some(Side::Table); 2],
            Kind::HeadHead => [Some(Side::Head); 2],
            Kind::TableHead => [None; 2],
        };
        let rotary = [rotary(source, first, sides[0])?, rotary(source, second, sides[1])?];
        if kind == Kind::TableHead && rotary[0].side == rotary[1].side {
            let value = second.value("on").map_or(0..0, |value| value.span);
            return Err(InputError::new(
                J008,
                "both axes are on the same side",
                "one on = \"table\" and one on = \"head\"",
                "correct one of them, or the kind",
            )
            .at(source, value));
        }
        let tool = root.section("tool")?.map_or(Ok(Tool::default()), |section| tool(source, &section))?;
        let travel_mm = root.section("travel")?.map_or(Ok([None; 3]), |section| travel(source, &section))?;
        root.close()?;
        let machine = Self::new(rotary, tool).map_err(|error| match error {
            MachineError::SameLetter(letter) => {
                let span = second.value("axis").map_or(0..0, |value| value.span);
                let found = format!("both rotary axes are {letter}");
                let help = "name the letter the program uses for each of them";
                InputError::new(J008, found, "two different letters", help).at(source, span)
            }
            other => InputError::new(J008, other.to_string(), "", "correct the machine file").at(source, 0..0),
        })?;
        let pole = pole.unwrap_or(machine.pole);
        Ok(Self { coordinates, travel_mm, pole, orientation_tolerance: orientation, ..machine })
    }
}

fn two_axes(source: &Source, root: &Section<'_>, found: usize) -> InputError {
    match root.value("rotary") {
        None => root.missing("rotary", "two tables [[rotary]]"),
        Some(value) => {
            let help = "a five-axis machine has two rotary axes: write one [[rotary]] for each";
            let found = format!("there are {found} tables [[rotary]]");
            InputError::new(J008, found, "two", help).at(source, value.span)
        }
    }
}

fn rotary(source: &Source, section: &Section<'_>, side: Option<Side>) -> Result<Rotary, InputError> {
    let letters = [("A", Letter::A), ("B", Letter::B), ("C", Letter::C)];
    let Some(letter) = section.choice("axis", &letters)? else {
        return Err(section.missing("axis", "one of \"A\", \"B\", \"C\""));
    };
    let sides = [("table", Side::Table), ("head", Side::Head)];
    let side = match (section.choice("on", &sides)?, side) {
        (Some(said), Some(must)) if said != must => {
            let value = section.value("on").map_or(0..0, |value| value.span);
            let found = "the axis is on the other side than the kind says";
            let help = "leave the key out, or correct the kind";
            return Err(InputError::new(J008, found, "a side that fits the kind", help).at(source, value));
        }
        (Some(said), _) => said,
        (None, Some(must)) => must,
        (None, None) => return Err(section.missing("on", "\"table\" or \"head\"")),
    };
    let point_mm = numbers(section, "point_mm", LENGTH(), "three lengths, [x, y, z]")?.unwrap_or([0.0; 3]);
    let senses = [("right-hand", Sense::RightHand), ("left-hand", Sense::LeftHand)];
    let sense = section.choice("turns", &senses)?.unwrap_or(Sense::RightHand);
    let limits_deg = range(source, section, "limits_deg", Limits::within("-1000000", "1000000", "degrees"))?;
    section.close()?;
    Ok(Rotary { letter, side, point_mm, sense, limits_deg })
}

fn tool(source: &Source, section: &Section<'_>) -> Result<Tool, InputError> {
    let length = section.number("length_mm", Limits::within("0", "2000", "mm"))?;
    let ball_radius = section.number("ball_radius_mm", Limits::above("0", "200", "mm"))?;
    let helix = section.number("helix_deg", Limits::within("0", "75", "degrees"))?;
    let choices = [("tip", Counted::Tip), ("centre", Counted::BallCentre)];
    let counted = section.choice("counts", &choices)?.unwrap_or(Counted::Tip);
    if let (None, Counted::BallCentre, Some(value)) = (ball_radius, counted, section.value("counts")) {
        let help = "add ball_radius_mm, or let the tip count";
        let found = "the ball's centre counts, but there is no tool.ball_radius_mm";
        return Err(InputError::new(J008, found, "the radius of the ball", help).at(source, value.span));
    }
    section.close()?;
    let number = |n: Option<Decimal>| n.map(Decimal::as_f64);
    Ok(Tool {
        length_mm: number(length).unwrap_or(0.0),
        ball_radius_mm: number(ball_radius),
        helix_deg: number(helix).unwrap_or(0.0),
        counted,
    })
}

fn travel(source: &Source, section: &Section<'_>) -> Result<[Option<[f64; 2]>; 3], InputError> {
    let x = range(source, section, "x_mm", LENGTH())?;
    let y = range(source, section, "y_mm", LENGTH())?;
    let z = range(source, section, "z_mm", LENGTH())?;
    section.close()?;
    Ok([x, y, z])
}

/// Two numbers, the lower first.
fn range(
    source: &Source,
    section: &Section<'_>,
    key: &'static str,
    limits: Limits,
) -> Result<Option<[f64; 2]>, InputError> {
    let Some(range) = numbers(section, key, limits, "two numbers, [lowest, highest]")? else { return Ok(None) };
    if range[0] <= range[1] {
        return Ok(Some(range));
    }
    let span = section.value(key).map_or(0..0, |value| value.span);
    let found = format!("{key} goes from {} down to {}", range[0], range[1]);
    Err(InputError::new(J008, found, "the lower end first", "swap the two numbers").at(source, span))
}

/// A list of `N` numbers, each within the limits.
fn numbers<const N: usize>(
    section: &Section<'_>,
    key: &'static str,
    limits: Limits,
    expected: &str,
) -> Result<Option<[f64; N]>, InputError> {
    let Some(value) = section.value(key) else { return Ok(None) };
    let help = "write the numbers between brackets, with commas between them";
    let Some(list) = value.raw.as_array() else { return Err(section.wrong_type(&value, expected, help)) };
    if list.len() != N {
        return Err(section.out_of_range(&value, expected, help));
    }
    let mut numbers = [0.0; N];
    for (number, entry) in numbers.iter_mut().zip(list.iter()) {
        *number = entry_number(section, &value, entry, limits)?;
    }
    Ok(Some(numbers))
}

fn entry_number(
    section: &Section<'_>,
    list: &Value<'_>,
    entry: &Spanned<DeValue<'_>>,
    limits: Limits,
) -> Result<f64, InputError> {
    let value = Value { path: list.path.clone(), span: entry.span(), raw: entry.get_ref(), inches: list.inches };
    section.number_in(&value, limits).map(Decimal::as_f64)
}
