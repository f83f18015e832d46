//! A control that executes verification programs line by line beside a simulated wall: as much of each dialect as the
//! programs use, from the controls' documentation. A move that should touch nothing and does is an error.

use super::wall::Wall;

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

/// The machine.
pub struct Control<'w> {
    wall: &'w Wall,
    /// Radius of the ball.
    ball: f64,
    /// Machine coordinates of the work origin.
    origin: [f64; 3],
    unit: f64,
    at: [f64; 3],
    /// #5061…#5063 and #5070.
    trip: [f64; 4],
    /// #185, #186.
    surface: [f64; 2],
    mode: u32,
    out: Printed,
}

impl<'w> Control<'w> {
    pub fn new(wall: &'w Wall, ball: f64) -> Self {
        Self {
            wall,
            ball,
            origin: [-310.0, -205.5, -99.25],
            unit: 1.0,
            at: [0.0, 0.0, 150.0],
            trip: [0.0; 4],
            surface: [f64::NAN; 2],
            mode: 0,
            out: Printed::default(),
        }
    }

    /// Executes a program to its end.
    pub fn run(mut self, program: &str) -> Result<Printed, String> {
        let lines: Vec<&str> = program.lines().collect();
        let mut next = 0;
        while let Some(line) = lines.get(next) {
            next += 1;
            let line = line.trim();
            self.out.lines += 1;
            if let Some(rest) = line.strip_prefix("IF[[ABS[#5061-[") {
                if let Some(target) = self.compare(rest) {
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
                    Err("ended in the middle".to_owned())
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
    fn compare(&self, text: &str) -> Option<u32> {
        let numbers: Vec<f64> = text
            .replace("#5062-", " ")
            .split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'))
            .filter_map(|t| t.parse().ok())
            .collect();
        let [x, y, limit, target] = numbers[..] else { panic!("IF {text}: {numbers:?}") };
        let [sx, sy, ..] = self.trip.map(|v| v / self.unit);
        ((sx - x).abs() + (sy - y).abs() < limit).then_some(target as u32)
    }

    fn block(&mut self, line: &str) -> Result<(), String> {
        if let Some(message) = line.strip_prefix("(LOG,") {
            let mut text = message.strip_suffix(')').unwrap().to_owned();
            for (k, v) in self.trip.into_iter().enumerate() {
                let number = if k < 3 { format!("{:.6}", v / self.unit) } else { format!("{v:.6}") };
                text = text.replace(["#5061", "#5062", "#5063", "#5070"][k], &number);
            }
            self.out.text += &format!("{text}\n");
            return Ok(());
        }
        if let Some(message) = line.strip_prefix("DPRNT[") {
            self.print(message.strip_suffix(']').unwrap());
            return Ok(());
        }
        if line.starts_with(['(', ';', '%', 'O', 'P']) {
            return Ok(());
        }
        let words: Vec<(char, f64)> = line
            .split_whitespace()
            .take_while(|w| !w.starts_with('('))
            .map(|w| (w.chars().next().unwrap(), w[1..].parse().unwrap_or_else(|_| panic!("word {w}"))))
            .collect();
        let word = |letter| words.iter().find(|w| w.0 == letter).map(|w| w.1);
        if words.contains(&('G', 20.0)) {
            self.unit = 25.4;
        }
        let unit = self.unit;
        let length = |letter| word(letter).map(|v| v * unit);
        let g = words.iter().find(|w| w.0 == 'G').map(|w| (w.1 * 10.0).round() as u32);
        match g {
            Some(650) => return self.call(word('P').unwrap() as u32, &length, word('A')),
            Some(0 | 10 | 310 | 383) => self.mode = g.unwrap(),
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
        let (from, low) = (self.at, self.at[2].min(to[2]) < self.wall.top);
        // Moving away while touching is how every touch ends.
        let leaves = self.wall.distance([to[0], to[1]]) > self.wall.distance([from[0], from[1]]);
        let meets = self.wall.meets([from[0], from[1]], [to[0], to[1]], self.ball);
        if low && meets.is_some_and(|t| t > 0.0 || !leaves) {
            return Err(format!("runs into the wall on the way to {to:?}"));
        }
        self.at = to;
        Ok(())
    }

    /// G38.3 or G31.
    fn search(&mut self, to: [f64; 3]) -> Result<(), String> {
        let meets = self.wall.meets([self.at[0], self.at[1]], [to[0], to[1]], self.ball);
        let meets = meets.filter(|_| self.at[2].min(to[2]) < self.wall.top);
        if meets == Some(0.0) && self.mode == 383 && self.at[2] < self.wall.top {
            return Err("alarm: the probe is on before the search".to_owned());
        }
        let share = meets.unwrap_or(1.0);
        if share == 0.0 && to[2] < self.at[2] {
            // From above: the ball stops on the wall.
            self.at[2] = self.at[2].min(self.wall.top - 0.01);
        } else {
            for (at, to) in self.at.iter_mut().zip(to) {
                *at += (to - *at) * share;
            }
        }
        let [x, y, z] = self.at;
        let hit = f64::from(u8::from(meets.is_some()));
        self.trip = [x, y, z, hit];
        self.out.touches += usize::from(meets.is_some());
        let [mx, my, mz] = [0, 1, 2].map(|k| self.at[k] + self.origin[k]);
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
        let t = self.wall.meets([at[0], at[1]], end, self.ball).ok_or("alarm: no surface found")?;
        self.out.touches += 1;
        self.surface = [0, 1].map(|k| at[k] + direction[k] * (way * t + self.ball));
        if number == 9811 {
            // Only the axis that moved has a result.
            self.surface = [0, 1].map(|k| if direction[k] == 0.0 { f64::NAN } else { self.surface[k] });
        }
        Ok(())
    }

    fn print(&mut self, text: &str) {
        let mut text = text.replace('*', " ");
        let values =
            [("#5061", self.trip[0]), ("#5062", self.trip[1]), ("#185", self.surface[0]), ("#186", self.surface[1])];
        for (name, value) in values {
            for (digits, width, decimals) in [("[44]", 10, 4), ("[35]", 10, 5)] {
                let number = format!("{:width$.decimals$}", value / self.unit);
                text = text.replace(&format!("{name}{digits}"), &number);
            }
        }
        assert!(!text.contains("NaN") && !text.contains('#'), "{text}");
        self.out.text += &format!("{text}\r\n");
    }
}
