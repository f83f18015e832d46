//! The table of `docs/safety.md`: each event with what it does to the axes, and within how many ticks. The tests of
//! the events take their numbers from here, and `safety_table.rs` compares the page with it.

/// Paths and names of tests.
macro_rules! tests {
    ($($file:literal $name:ident),+) => { &[$(concat!($file, ".rs::", stringify!($name))),+] };
}

mod cut;
mod link;
mod part;

/// One line of the table, for the settings of the tests: 1 kHz, clamp 0.5 mm, 20 mm/s, 1 m/s², two lost frames.
pub struct Row {
    pub event: &'static str,
    /// What goes to the axes.
    pub axes: &'static str,
    /// The state it leads to.
    pub state: &'static str,
    /// Ticks until the state is the new one; the first tick of the event is number 1. None: it never changes.
    pub noticed: Option<u32>,
    /// Ticks from then on until nothing is left of the correction. None: it stays.
    pub out: Option<u32>,
    /// Tests that hold it, as path and name.
    pub tests: &'static [&'static str],
}

/// All rows in the order of the page.
pub fn rows() -> impl Iterator<Item = &'static Row> {
    [link::LINK, cut::CUT, part::PART].into_iter().flatten()
}

pub fn row(event: &str) -> &'static Row {
    rows().find(|row| row.event == event).unwrap_or_else(|| panic!("no row {event}"))
}

const fn new(
    event: &'static str,
    axes: &'static str,
    state: &'static str,
    noticed: Option<u32>,
    out: Option<u32>,
    tests: &'static [&'static str],
) -> Row {
    Row { event, axes, state, noticed, out, tests }
}

const NOTHING: &str = "nothing is forwarded in this tick";
const CORRECTED: &str = "corrected, as if nothing had happened";
const RAMP: &str = "the correction ramps to zero within its limits, then the setpoint";
const PLAIN: &str = "the setpoint, unchanged";
const SAME: &str = "unchanged";
const FAULT: &str = "Fault, then Bypass";
const END: &str = "Active until the correction is out, then Bypass";
const OFF: &str = "Off";
const DROPPED: &str = "nothing; the drive enable is dropped";
const FADE: &str = "the correction fades to zero, and comes back when the cause is gone";
/// Longest ramp from the clamp and against the speed.
const LONGEST: Option<u32> = Some(121);

/// The table as it stands on the page.
pub fn text() -> String {
    let mut text = String::from(
        "| event while active | what goes to the axes | state | noticed in tick | correction out within | tests |\n\
         |---|---|---|---:|---:|---|\n",
    );
    for row in rows() {
        let noticed = row.noticed.map_or("–".to_owned(), |ticks| ticks.to_string());
        let out = row.out.map_or("stays".to_owned(), |ticks| format!("{ticks} ticks"));
        let out = if matches!(row.state, "Bypass" | "Armed") || row.state.starts_with("Bypass;") {
            "none is on"
        } else {
            &out
        };
        let name = |test: &&str| format!("`{}`", test.rsplit("::").next().unwrap());
        let file = |test: &&str| test.split(".rs").next().unwrap().rsplit('/').next().unwrap().to_owned();
        let tests: Vec<_> = row.tests.iter().map(|test| format!("{}: {}", file(test), name(test))).collect();
        let cells = [row.event, row.axes, row.state, &noticed, out, &tests.join("<br>")];
        text.push_str(&format!("| {} |\n", cells.join(" | ")));
    }
    text
}
