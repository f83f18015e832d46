//! A control that executes verification programs line by line beside a wall: as much of each dialect as the programs of
//! `truepath probe` use, from the controls' documentation. A move that should touch nothing and does is an error.
//!
//! It knows nothing of the planner: what it is given is text and a wall.

/// A point of the XY plane, mm.
pub type Xy = [f64; 2];

/// What a ball is moved beside.
pub trait Wall {
    /// Z at which it ends, mm.
    fn top(&self) -> f64;
    /// The share of the way at which a ball of a radius, its centre at the height `z`, meets it first.
    fn meets(&mut self, z: f64, from: Xy, to: Xy, radius: f64) -> Option<f64>;
    /// Distance of a point from it at a height, mm.
    fn distance(&mut self, z: f64, point: Xy) -> f64;
    /// What a reading of the ball that stopped at `at` is off along its way, mm; `way` is its direction in the plane.
    fn off(&mut self, _at: [f64; 3], _way: Xy) -> f64 {
        0.0
    }
}

/// What a control prints, by the channels of the dialects.
#[derive(Debug, Default)]
pub struct Printed {
    /// LinuxCNC's log, or what DPRNT sent.
    pub text: String,
    /// grbl's console.
    pub console: String,
    /// Touches, slow and fast.
    pub touches: usize,
    /// Lines executed.
    pub lines: usize,
}

impl Printed {
    /// The file that the user has after the program has run: the log, what DPRNT sent, or grbl's console with the answers
    /// to `$$` and `$#`.
    pub fn file(&self) -> String {
        if !self.text.is_empty() {
            return self.text.clone();
        }
        let [x, y, z] = ORIGIN_MM;
        let offsets: String = (54..60).map(|g| format!("[G{g}:{x:.3},{y:.3},{z:.3}]\n")).collect();
        format!("$13=0\nok\n{}{offsets}[G92:0.000,0.000,0.000]\n[TLO:0.000]\nok\n", self.console)
    }
}

/// Machine coordinates of the work origin.
const ORIGIN_MM: [f64; 3] = [-310.0, -205.5, -99.25];

/// The machine.
#[derive(Debug)]
pub struct Control<'w, W> {
    wall: &'w mut W,
    /// Radius of the ball.
    ball: f64,
    unit: f64,
    at: [f64; 3],
    /// #5061…#5063 and #5070.
    trip: [f64; 4],
    /// #185, #186.
    surface: [f64; 2],
    mode: u32,
    out: Printed,
}

impl<'w, W: Wall> Control<'w, W> {
    /// Beside a wall, with a ball of a radius in the spindle, mm.
    pub fn new(wall: &'w mut W, ball: f64) -> Self {
        Self {
            wall,
            ball,
            unit: 1.0,
            at: [0.0, 0.0, 150.0],
            trip: [0.0; 4],
            surface: [f64::NAN; 2],
            mode: 0,
            out: Printed::default(),
        }
    }

    /// Executes a program to its end.
    ///
    /// # Errors
    /// The line that this control does not know or that drives the ball into the wall, in words.
    pub fn run(mut self, program: &str) -> Result<Printed, String> {
        let lines: Vec<&str> = program.lines().collect();
        let mut next = 0;
        while let Some(line) = lines.get(next) {
            next += 1;
            let line = line.trim();
            self.out.lines += 1;
            if let Some(rest) = line.strip_prefix("IF[[ABS[#5061-[") {
                if let Some(target) = self.compare(rest)? {
                    let label = format!("N{target} ");
                    next = lines.iter().position(|l| l.starts_with(&label)).ok_or(format!("no block {label}"))?;
                }
            } else if line.starts_with('o') && line.ends_with("if [#5070 NE 0]") {
                if self.trip[3] == 0.0 {
                    let end = line.replace("if [#5070 NE 0]", "endif");
                    next += 1 + lines[next..].iter().position(|l| l.trim() == end).ok_or("no endif")?;
                }
            } else if matches!(line, "M2" | "M30") {
                return if self.trip[3] != 0.0 && line == "M2" && lines[next..].iter().any(|l| l.contains("G38.3")) {
                    Err("the ball touches where nothing should be: the program ends itself in the middle".to_owned())
                } else {
                    Ok(self.out)
                };
            } else if line.starts_with("#3000") {
                return Err(line.to_owned());
            } else {
                self.block(line).map_err(|e| format!("line {next}, {line}: {e}"))?;
            }
        }
        Err("the program does not end".to_owned())
    }

    /// `a]]+ABS[#5062-[b]]]LTv]GOTOn`: the target when the comparison holds.
    fn compare(&self, text: &str) -> Result<Option<u32>, String> {
        let numbers: Vec<f64> = text
            .replace("#5062-", " ")
            .split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'))
            .filter_map(|t| t.parse().ok())
            .collect();
        let [x, y, limit, target] = numbers[..] else { return Err(format!("IF {text}: four numbers expected")) };
        let [sx, sy, ..] = self.trip.map(|v| v / self.unit);
        Ok(((sx - x).abs() + (sy - y).abs() < limit).then_some(target as u32))
    }

    fn block(&mut self, line: &str) -> Result<(), String> {
        if let Some(message) = line.strip_prefix("(LOG,") {
            let mut text = message.strip_suffix(')').ok_or("a comment without its end")?.to_owned();
            for (k, v) in self.trip.into_iter().enumerate() {
                let number = if k < 3 { format!("{:.6}", v / self.unit) } else { format!("{v:.6}") };
                text = text.replace(["#5061", "#5062", "#5063", "#5070"][k], &number);
            }
            self.out.text += &format!("{text}\n");
            return Ok(());
        }
        if let Some(message) = line.strip_prefix("DPRNT[") {
            return self.print(message.strip_suffix(']').ok_or("DPRNT without its end")?);
        }
        if line.starts_with(['(', ';', '%', 'O', 'P']) {
            return Ok(());
        }
        let read = |word: &str| {
            let mut letters = word.chars();
            let (letter, value) = (letters.next(), letters.as_str().parse().ok());
            letter.zip(value).ok_or_else(|| format!("the word {word} is not known"))
        };
        let words = line.split_whitespace().take_while(|w| !w.starts_with('(')).map(read);
        let words: Vec<(char, f64)> = words.collect::<Result<_, _>>()?;
        let word = |letter| words.iter().find(|w| w.0 == letter).map(|w| w.1);
        if words.contains(&('G', 20.0)) {
            self.unit = 25.4;
        }
        let unit = self.unit;
        let length = |letter| word(letter).map(|v| v * unit);
        let g = words.iter().find(|w| w.0 == 'G').map(|w| (w.1 * 10.0).round() as u32);
        match g {
            Some(650) => return self.call(word('P').ok_or("G65 without P")? as u32, &length, word('A')),
            Some(mode @ (0 | 10 | 310 | 383)) => self.mode = mode,
            _ => {}
        }
        let [x, y, z] = ['X', 'Y', 'Z'].map(length);
        if x.or(y).or(z).is_none() {
            return Ok(());
        }
        let to = [x.unwrap_or(self.at[0]), y.unwrap_or(self.at[1]), z.unwrap_or(self.at[2])];
        match self.mode {
            383 | 310 => self.search(to),
            _ => self.travel(to),
        }
    }

    /// A move without touching.
    fn travel(&mut self, to: [f64; 3]) -> Result<(), String> {
        let (from, z) = (self.at, self.at[2].min(to[2]));
        // Moving away while touching is how every touch ends.
        let leaves = self.wall.distance(z, [to[0], to[1]]) > self.wall.distance(z, [from[0], from[1]]);
        let meets = self.wall.meets(z, [from[0], from[1]], [to[0], to[1]], self.ball);
        if z < self.wall.top() && meets.is_some_and(|t| t > 0.0 || !leaves) {
            return Err(format!("runs into the wall on the way to {to:?}"));
        }
        self.at = to;
        Ok(())
    }

    /// What a reading is off after the way from `start` to where the ball is now, x, y and z.
    fn off(&mut self, start: [f64; 3]) -> [f64; 3] {
        let way: [f64; 3] = std::array::from_fn(|k| self.at[k] - start[k]);
        let length = way.iter().map(|v| v * v).sum::<f64>().sqrt();
        let [x, y, _] = way.map(|v| if length > 0.0 { v / length } else { 0.0 });
        let off = self.wall.off(self.at, [x, y]);
        way.map(|v| if length > 0.0 { v / length * off } else { 0.0 })
    }

    /// G38.3 or G31.
    fn search(&mut self, to: [f64; 3]) -> Result<(), String> {
        let (z, top) = (self.at[2].min(to[2]), self.wall.top());
        let meets = self.wall.meets(z, [self.at[0], self.at[1]], [to[0], to[1]], self.ball);
        let meets = meets.filter(|_| z < top);
        if meets == Some(0.0) && self.mode == 383 && self.at[2] < top {
            return Err("alarm: the probe is on before the search".to_owned());
        }
        let (share, start) = (meets.unwrap_or(1.0), self.at);
        if share == 0.0 && to[2] < self.at[2] {
            // From above: the ball stops on the wall.
            self.at[2] = self.at[2].min(top - 0.01);
        } else {
            for (at, to) in self.at.iter_mut().zip(to) {
                *at += (to - *at) * share;
            }
        }
        let hit = f64::from(u8::from(meets.is_some()));
        let off = if meets.is_some() { self.off(start) } else { [0.0; 3] };
        let read = [0, 1, 2].map(|k| self.at[k] + off[k]);
        self.trip = [read[0], read[1], read[2], hit];
        self.out.touches += usize::from(meets.is_some());
        let [mx, my, mz] = [0, 1, 2].map(|k| read[k] + ORIGIN_MM[k]);
        self.out.console += &format!("ok\n[PRB:{mx:.3},{my:.3},{mz:.3}:{hit}]\n");
        Ok(())
    }

    /// Inspection Plus.
    fn call(&mut self, number: u32, word: &dyn Fn(char) -> Option<f64>, angle: Option<f64>) -> Result<(), String> {
        let at = self.at;
        let (direction, distance) = match number {
            9832 | 9833 => return Ok(()),
            9810 => {
                let to = [word('X').unwrap_or(at[0]), word('Y').unwrap_or(at[1]), word('Z').unwrap_or(at[2])];
                return self.travel(to);
            }
            9811 => match (word('X'), word('Y')) {
                (Some(x), None) => ([(x - at[0]).signum(), 0.0], (x - at[0]).abs()),
                (None, Some(y)) => ([0.0, (y - at[1]).signum()], (y - at[1]).abs()),
                _ => return Err("P9811 takes one axis".to_owned()),
            },
            9821 => {
                let angle = angle.ok_or("P9821 without A")?.to_radians();
                ([angle.cos(), angle.sin()], word('D').ok_or("P9821 without D")?)
            }
            _ => return Err(format!("P{number} is not known")),
        };
        let way = distance - self.ball + word('Q').ok_or("no Q")?;
        let end = [at[0] + direction[0] * way, at[1] + direction[1] * way];
        let t = self.wall.meets(at[2], [at[0], at[1]], end, self.ball).ok_or("alarm: no surface found")?;
        self.out.touches += 1;
        let stopped = [at[0] + direction[0] * way * t, at[1] + direction[1] * way * t, at[2]];
        let reached = way * t + self.ball + self.wall.off(stopped, direction);
        self.surface = [0, 1].map(|k| at[k] + direction[k] * reached);
        if number == 9811 {
            // Only the axis that moved has a result.
            self.surface = [0, 1].map(|k| if direction[k] == 0.0 { f64::NAN } else { self.surface[k] });
        }
        Ok(())
    }

    fn print(&mut self, text: &str) -> Result<(), String> {
        let mut text = text.replace('*', " ");
        let values =
            [("#5061", self.trip[0]), ("#5062", self.trip[1]), ("#185", self.surface[0]), ("#186", self.surface[1])];
        for (name, value) in values {
            for (digits, width, decimals) in [("[44]", 10, 4), ("[35]", 10, 5)] {
                let number = format!("{:width$.decimals$}", value / self.unit);
                text = text.replace(&format!("{name}{digits}"), &number);
            }
        }
        if text.contains("NaN") || text.contains('#') {
            return Err(format!("what it prints has no value: {text}"));
        }
        self.out.text += &format!("{text}\r\n");
        Ok(())
    }
}
