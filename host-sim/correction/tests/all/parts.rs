//! The programs that plans are written into, and what reads them back.

use std::path::Path as FilePath;

use truepath_core::correct::Node;
use truepath_core::cut::Path;
use truepath_core::geometry::{Block, Curve, Point, Shape, Vector};
use truepath_core::units::{Offset, Real};
use truepath_correction::planned::{PlannedPass, PlannedProgram, write};
use truepath_ground::diagnostics::{Failure, Form, Source};
use truepath_job::feature::Survey;
use truepath_job::job::JobFile;
use truepath_job::pass::{Pass, PathBuffer};

/// A program and what its job says beside the usual.
#[derive(Clone, Copy)]
pub struct Part {
    pub name: &'static str,
    pub program: &'static str,
    /// Keys of the head, of `[stock]`, of `[tool]`.
    pub job: [&'static str; 3],
}

/// The corner of the papers.
pub const CORNER: Part = Part {
    name: "corner",
    program: "%\nO0001\nG00 G90 G49 G40 G17 G21\nG91 G28 Z0.\nG91 G28 X0. Y0.\nG90 G54\nT01 M06 (Freza d20)\nS1500 M03\n\
              G00 Z10. X34. Y80. M08\nG01 Z-15. F400.\nG01 X34. Y35. F250.\nG03 X39. Y30. I5. J0 F150.\nG01 X90. Y30. F250.\n\
              G00 Z100.\nG00 X0. Y0.\nM09\nM05\nM30\n%\n",
    job: ["wall = \"right\"", "allowance_mm = 3.0", "diameter_mm = 20.0"],
};

/// A pocket with arcs to its wall and away from it.
pub const POCKET: Part = Part {
    name: "pocket with arcs",
    program: "G21 G90 G17\nT2 M6\nS9000 M3\nG0 X30 Y12 Z10\nG0 Z2\nG1 Z-8 F300\n(wall)\nN50 G1 X34 Y8 F500\nG2 X30 Y4 I-4 J0\nN60 G1 X10 F700 (left)\n\
              G2 X4 Y10 I0 J6\nG1 Y30\nG2 X10 Y36 I6 J0\nG1 X50\nG2 X56 Y30 I0 J-6\nG1 Y10\nG2 X50 Y4 I-6 J0\nG1 X30\n\
              G2 X26 Y8 I0 J4\nG1 X30 Y12\nG0 Z10\nM5\nM30\n",
    job: ["wall = \"left\"", "allowance_mm = 0.5", "diameter_mm = 8.0"],
};

/// A wall of the drawing under G41, the radius in D.
pub const HAAS: Part = Part {
    name: "Haas G41",
    program: "%\nO0042 (BEARING BRACKET)\n(T3 12MM CARBIDE 4 FL)\nG00 G17 G21 G40 G49 G80 G90\nG91 G28 Z0\nT3 M06\nG90 G54 G00 X-20. Y-20.\nS3500 M03\n\
              G43 H03 Z25. M08\nG00 Z2.\nG01 Z-10. F500.\nG41 D03 X0. Y-10. F600.\nY60.\nX70.\nG02 X90. Y40. R20.\nG01 Y0.\nX-12.\nG40 X-20. Y-20.\n\
              G00 Z25. M09\nG91 G28 Z0 M05\nG28 Y0\nM30\n%\n",
    job: ["dialect = \"haas\"", "allowance_mm = 0.5", "diameter_mm = 12\ncompensation = \"radius\""],
};

/// The same with wear in D: the path is that of the centre.
pub const WEAR: Part = Part {
    name: "Haas G41 with wear",
    job: ["dialect = \"haas\"", "allowance_mm = 0.5", "diameter_mm = 12\ncompensation = \"centre\""],
    ..HAAS
};

/// Inches, incremental behind the way down.
pub const INCH: Part = Part {
    name: "inches, incremental",
    program: "%\nO5 (PLATE)\nG20 G90 G17\nT1 M6\nS4000 M3\nG0 X-.5 Y0.\nZ.4\nG1 Z-.3 F20.\nG91 G1 X.5 F16.\nX2.\nG3 X.25 Y.25 I0. J.25\nG1 Y1.5\nX-.1\nG90 G0 Z4.\nX0.\nM30\n%\n",
    job: ["wall = \"right\"", "allowance_mm = 0.4", "diameter_mm = 10"],
};

/// LinuxCNC with G64, a comment with a semicolon, lower case.
pub const G64: Part = Part {
    name: "LinuxCNC G64",
    program: "; side wall\ng21 g90 g17 g64 p0.005\nt1 m6\ns4000 m3\ng0 x-10 y-12\ng0 z10\ng0 z1\ng1 z-10 f500\ng1 y50 f600 ; first leg\ng2 x5 y65 i15 j0\n\
              g1 x100\ng0 z10\ng0 x0 y0\nm2\n",
    job: ["wall = \"right\"", "allowance_mm = 0.5", "diameter_mm = 10.0"],
};

/// Sinumerik, the outline of the part under G41.
pub const SIEMENS: Part = Part {
    name: "Sinumerik",
    program: "N10 G17 G71 G90 G54 G40\nN20 T=\"FRAESER_D10\" D1\nN30 M6\nN40 S4500 M3\nN50 G0 X-15 Y-15 Z50\nN60 G0 Z2 M8\nN70 G1 Z-8 F300\nN80 G41 X0 Y-8 F650\nN90 Y40\n\
              N100 G2 X8 Y48 CR=8\nN110 G1 X70\nN120 Y0\nN130 X-8\nN140 G40 X-15 Y-15\nN150 G0 Z100 M9\nN160 SUPA G0 Z500 D0\nN170 M30\n",
    job: ["dialect = \"siemens\"", "allowance_mm = 0.4", "diameter_mm = 10\ncompensation = \"radius\""],
};

/// Two depths, the first with a spring pass behind it.
pub const SPRING: Part = Part {
    name: "two depths with spring passes",
    program: "G21 G90 G17\nT1 M6\nS5000 M3\nG0 X-12 Y0 Z20\nG0 Z2\nG1 Z-6 F300\nG1 X0 F500\nG1 X60\nG3 X70 Y10 I0 J10\nG1 Y50\nG1 X68 Y60\nG0 Z5\nG0 X-12 Y0\nG1 Z-6 F300\nG1 X0 F500\nG1 X60\n\
              G3 X70 Y10 I0 J10\nG1 Y50\nG1 X68 Y60\nG0 Z5\nG0 X-12 Y0\nG1 Z-12 F300\nG1 X0 F500\nG1 X60\nG3 X70 Y10 I0 J10\nG1 Y50\nG1 X68 Y60\nG0 Z20\nM30\n",
    job: ["wall = \"right\"", "allowance_mm = 0.5", "diameter_mm = 10.0"],
};

/// Three depths by a subprogram.
pub const SUBPROGRAM: Part = Part {
    name: "depths by a subprogram",
    program: "%\nO10\nG21 G90 G17\nT1 M6\nS5000 M3\nG0 X-12 Y0 Z20\nG0 Z0\nM98 P20 L3\nG90 G0 Z20\nM30\nO20\nG91 G1 Z-4 F300\nG90 G1 X60 F500\nG3 X70 Y10 I0 J10\nG1 Y50\nG1 X64 Y60\n\
              G91 G0 Z30\nG90 G0 X-12 Y0\nG91 G0 Z-30\nM99\n%\n",
    job: ["dialect = \"fanuc\"\nwall = \"right\"", "allowance_mm = 0.5", "diameter_mm = 10.0"],
};

pub fn shown<T>(result: Result<T, Failure>) -> T {
    result.unwrap_or_else(|e| panic!("{}", e.render(Form::Plain)))
}

impl Part {
    pub fn source(&self) -> Source {
        Source::new("part.nc", self.program.as_bytes().to_vec())
    }

    pub fn job(&self) -> JobFile {
        self.job_and("")
    }

    /// The job with further tables.
    pub fn job_and(&self, tables: &str) -> JobFile {
        let [head, stock, tool] = self.job;
        let text = format!(
            "version = 1\nprogram = \"part.nc\"\n{head}\n[stock]\n{stock}\n[tool]\n{tool}\nteeth = 4\nhelix_deg = 35.0\n[cut]\n\
             axial_depth_mm = 4.0\n[force]\nmaterial = \"al-7075-t6\"\n[machine]\nstiffness_x_n_per_mm = 1900\n\
             stiffness_y_n_per_mm = 1900\n[probe]\nball_diameter_mm = 4.0\nformat = \"linuxcnc\"\nz_reference = \"centre\"\n{tables}"
        );
        shown(JobFile::parse(Source::new("job.toml", text.into_bytes()), FilePath::new("")).map_err(Failure::from))
    }

    pub fn pass(&self) -> Pass {
        shown(Pass::new(self.job(), self.source()))
    }

    /// The program with a plan; `plan` makes it from the path.
    pub fn written(&self, plan: impl Fn(&Path<'_>) -> Vec<PlannedPass>) -> Result<Written, Failure> {
        let pass = self.pass();
        let mut buffer = PathBuffer::default();
        let path = shown(pass.sample(&mut buffer));
        let passes = plan(&path);
        let program = write(&pass, &path, &passes, Some(1))?;
        let points = path.samples()[path.first()..path.first() + path.count()].iter();
        let points = points.map(|sample| [sample.point.x.nm(), sample.point.y.nm()]).collect();
        Ok(Written { passes, points, program, feeds: pass.blocks.iter().map(|b| b.feed).collect() })
    }
}

/// A written program with what was asked for.
pub struct Written {
    pub passes: Vec<PlannedPass>,
    /// The contour of the original, nm.
    pub points: Vec<[i64; 2]>,
    pub program: PlannedProgram,
    pub feeds: Vec<Real>,
}

impl Written {
    pub fn text(&self) -> &str {
        std::str::from_utf8(&self.program.text).expect("ASCII")
    }

    /// Every pass is on its lines where the plan wants it, at its height and feed; gives the largest distance, mm.
    pub fn cuts_as_planned(&self, part: &Part) -> f64 {
        let wall = Wall { passes: &self.passes, points: &self.points, feeds: &self.feeds };
        cut_as_planned(part.name, &self.program, &part.job(), &[wall])
    }
}

/// What was asked for along a wall: the contour of the original, nm, and its feeds.
pub struct Wall<'a> {
    pub passes: &'a [PlannedPass],
    pub points: &'a [[i64; 2]],
    pub feeds: &'a [Real],
}

/// Reads a written program back; gives the largest distance of a pass from its plan, mm.
pub fn cut_as_planned(name: &str, program: &PlannedProgram, job: &JobFile, walls: &[Wall<'_>]) -> f64 {
    let source = Source::new("written.nc", program.text.clone());
    let survey = Survey::read(job, &source).expect("a readable program");
    let text = String::from_utf8_lossy(&program.text);
    let mut largest = 0.0f64;
    for depth in &program.depths {
        let wall = &walls[depth.wall];
        for ((planned, lines), z) in wall.passes.iter().zip(&depth.passes).zip(&depth.z_mm) {
            let on = |line: u32| lines[0] <= line && line <= lines[1];
            let runs: Vec<_> = survey.runs.iter().filter(|found| on(found.run.lines.first)).collect();
            let [found] = runs[..] else { panic!("{name}: {} runs on {lines:?}\n{text}", runs.len()) };
            assert!(on(found.run.lines.last), "{name}: {text}");
            assert_eq!(found.run.z.map(|z| z.nm()), Some((z * 1e6).round() as i64), "{name}");
            let blocks = found.blocks(&survey.blocks);
            largest = largest.max(wall.deviation(planned, blocks));
            let float = |feed: Real| truepath_ground::units::float(feed);
            let wanted =
                |feed: f64| wall.feeds.iter().any(|own| (float(*own) * planned.feed - feed).abs() < 0.06 * 25.4);
            let fed = blocks.iter().filter(|block| wanted(float(block.feed))).count();
            assert!(2 * fed > blocks.len(), "{name}: feeds of {lines:?}\n{text}");
        }
    }
    largest
}

impl Wall<'_> {
    /// How far the wanted points are from some blocks, mm; they are passed in their order.
    fn deviation(&self, planned: &PlannedPass, blocks: &[Block]) -> f64 {
        let spot = |k: usize| self.points.get(k);
        // On the spot of a sharp corner the pass steps from the first to the last of the displacements there.
        let between = |k: &usize| *k > 0 && spot(k - 1) == spot(*k) && spot(*k) == spot(k + 1);
        let place = |k: usize| {
            let (p, d) = (self.points[k], planned.nodes[k].total());
            [p[0] + d.x.nm(), p[1] + d.y.nm()]
        };
        let mut wanted: Vec<[i64; 2]> = (0..self.points.len()).filter(|k| !between(k)).map(place).collect();
        if planned.reversed {
            wanted.reverse();
        }
        let (mut at, mut largest) = (0usize, 0.0f64);
        for point in wanted {
            let ahead: Vec<f64> = blocks[at..].iter().take(12).map(|block| distance(point, &block.curve)).collect();
            let nearest = ahead.iter().copied().fold(f64::INFINITY, f64::min);
            // Where a contour closes, the first that is near enough is meant.
            let skipped = ahead.iter().position(|off| *off <= nearest.max(1_500.0)).expect("a block");
            let off = ahead[skipped];
            // The nearest block is never far behind: what is passed is passed.
            at = (at + skipped).saturating_sub(2);
            largest = largest.max(off);
        }
        largest / 1e6
    }
}

/// The distance of a point from a line or arc, nm.
fn distance(point: [i64; 2], curve: &Curve) -> f64 {
    let from = |p: Point| [(point[0] - p.x.nm()) as f64, (point[1] - p.y.nm()) as f64];
    let (a, b) = (from(curve.start()), from(curve.end()));
    let ends = a[0].hypot(a[1]).min(b[0].hypot(b[1]));
    match curve.shape() {
        Shape::Line => {
            let d = [a[0] - b[0], a[1] - b[1]];
            let u = ((d[0] * a[0] + d[1] * a[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
            (a[0] - u * d[0]).hypot(a[1] - u * d[1])
        }
        Shape::Arc { centre, sweep } => {
            let angle = |p: Point| ((p.y - centre.y).nm() as f64).atan2((p.x - centre.x).nm() as f64);
            let spoke = from(centre);
            let turned = (spoke[1].atan2(spoke[0]) - angle(curve.start())) * sweep.bits().signum() as f64;
            let within = turned.rem_euclid(std::f64::consts::TAU) <= sweep.bits().abs() as f64 / 4_294_967_296.0;
            let radius = curve.signed_radius().map_or(0.0, |r| r.nm().abs() as f64);
            if within { ends.min((spoke[0].hypot(spoke[1]) - radius).abs()) } else { ends }
        }
    }
}

/// A pass that stays `away` from the wall, mm, and is corrected by up to 0.05 mm more.
pub fn pass(path: &Path<'_>, away: f64, raise: f64, reversed: bool, feed: f64) -> PlannedPass {
    let samples = &path.samples()[path.first()..path.first() + path.count()];
    let middle = path.count() as f64 / 2.0;
    let node = |(k, sample): (usize, &truepath_core::cut::Sample)| {
        let bump = 0.05 / (1.0 + ((k as f64 - middle) / 60.0).powi(2));
        let by = Offset::from_nm(((bump - away) * 1e6) as i64);
        Node { chip: sample.normal.times(by), ..Node::default() }
    };
    let nodes = samples.iter().enumerate().map(node).collect();
    PlannedPass { nodes, raise: Offset::from_nm((raise * 1e6) as i64), reversed, feed }
}

/// A pass that is moved by nothing.
pub fn unmoved(path: &Path<'_>) -> PlannedPass {
    let nodes = vec![Node { chip: Vector::ZERO, ..Node::default() }; path.count()];
    PlannedPass { nodes, raise: Offset::ZERO, reversed: false, feed: 1.0 }
}
