//! A drawn SVG read back: its lines in the units of its axes.

/// An axis: value = start + place · unit.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    start: f64,
    each: f64,
}

impl Axis {
    /// From the places and values of its ticks.
    fn of(ticks: &[(f64, f64)]) -> Self {
        let (first, last) = (ticks.first().expect("a tick"), ticks.last().expect("a tick"));
        let each = (last.1 - first.1) / (last.0 - first.0);
        Self { start: first.1 - first.0 * each, each }
    }
    fn value(self, place: f64) -> f64 {
        self.start + place * self.each
    }
    /// What one unit of the drawing, a tenth of a pixel, is, with the rounding of the ticks it is told from.
    pub fn unit(self) -> f64 {
        1.5 * self.each.abs()
    }
}

/// The axes of one diagram, and its extent in the drawing.
#[derive(Clone, Copy, Debug)]
pub struct Axes {
    pub x: Axis,
    pub y: Axis,
    top: f64,
    bottom: f64,
}

/// A picture.
pub struct Drawing {
    text: String,
}

fn attribute<'a>(tag: &'a str, name: &str) -> &'a str {
    let begin = format!(" {name}=\"");
    let from = tag.find(&begin).unwrap_or_else(|| panic!("no {name} in {tag}")) + begin.len();
    tag[from..].split('"').next().unwrap()
}

fn number(tag: &str, name: &str) -> f64 {
    attribute(tag, name).parse().unwrap()
}

fn points(tag: &str) -> Vec<(f64, f64)> {
    let point = |p: &str| {
        let (x, y) = p.split_once(',').unwrap();
        (x.parse().unwrap(), y.parse().unwrap())
    };
    attribute(tag, "points").split_whitespace().map(point).collect()
}

impl Drawing {
    pub fn new(svg: &[u8]) -> Self {
        Self { text: String::from_utf8(svg.to_vec()).unwrap() }
    }

    fn tags<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a str> {
        self.text.split('<').filter(move |tag| tag.strip_prefix(name).is_some_and(|rest| rest.starts_with(' ')))
    }

    pub fn texts(&self) -> impl Iterator<Item = &str> {
        self.tags("text").map(|tag| tag.split_once('>').unwrap().1.trim())
    }

    pub fn circles(&self) -> usize {
        self.tags("circle").count()
    }

    /// Diagrams from top to bottom; the last one above which there are no other numbers below shares its lower axis.
    pub fn axes(&self, panel: usize) -> Axes {
        // The frame is a closed polyline of four corners.
        let frames: Vec<Vec<(f64, f64)>> =
            self.tags("polyline").map(points).filter(|p| p.len() == 5 && p[0] == p[4]).collect();
        let frame = &frames[panel];
        let ends = |at: fn(&(f64, f64)) -> f64| {
            frame.iter().map(at).fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)))
        };
        let ((top, bottom), (left, _)) = (ends(|p| p.1), ends(|p| p.0));
        let labels: Vec<(f64, f64, &str, f64)> = self
            .tags("text")
            .filter_map(|tag| {
                let value = tag.split_once('>')?.1.trim().replace('−', "-").parse().ok()?;
                Some((number(tag, "x"), number(tag, "y"), attribute(tag, "text-anchor"), value))
            })
            .collect();
        let y = labels.iter().filter(|l| l.2 == "end" && l.0 < left && l.1 >= top - 1.0 && l.1 <= bottom + 1.0);
        let mut y: Vec<(f64, f64)> = y.map(|l| (l.1, l.3)).collect();
        let mut below: Vec<_> = labels.iter().filter(|l| l.2 == "middle" && l.1 > bottom).collect();
        below.sort_by(|a, b| a.1.total_cmp(&b.1));
        let row = below.first().expect("numbers below").1;
        let mut x: Vec<(f64, f64)> = below.iter().filter(|l| l.1 == row).map(|l| (l.0, l.3)).collect();
        for ticks in [&mut x, &mut y] {
            ticks.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        Axes { x: Axis::of(&x), y: Axis::of(&y), top, bottom }
    }

    /// All points of the lines of a colour in a diagram, in its units.
    pub fn line(&self, colour: &str, axes: Axes) -> Vec<(f64, f64)> {
        let lines = self.tags("polyline").filter(|tag| attribute(tag, "stroke") == colour).map(points);
        let inside = |p: &(f64, f64)| p.1 >= axes.top && p.1 <= axes.bottom;
        let lines = lines.filter(|line| line.iter().all(inside));
        let found: Vec<(f64, f64)> = lines.flatten().map(|p| (axes.x.value(p.0), axes.y.value(p.1))).collect();
        assert!(!found.is_empty(), "no line of {colour}");
        found
    }
}
