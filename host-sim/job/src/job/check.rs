//! From tables and keys to a [`JobFile`]: presence, ranges, choices and contradictions.

use std::cell::RefCell;
use std::path::Path;

use toml::de::DeTable;
use truepath_core::gcode::{ArcCentres, PointlessLength};
use truepath_core::geometry::Side;
use truepath_core::job::{Cut, Force, ForceModel, Machine};
use truepath_core::units::{Offset, Real};
use truepath_ground::codes::J008;
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::{InputError, Source};
use truepath_ground::document::{Section, Spans};
use truepath_ground::limits::Limits;
use truepath_ground::notation;

use super::check_correct::correct;
use super::check_feature::features;
use super::check_feed::feed;
use super::check_part::part;
use super::check_plan::plan;
use super::check_pocket::{Mode, pocket};
use super::check_probe::probe;
use super::check_stock::{Stock, stock};
use super::check_store::store;
use super::check_tool::{reach, tool};
use super::material::MATERIALS;
use super::measured;
use super::open::{Assumed, DIALECTS, Open, usual_machine};
use super::{JobFile, Which};

/// The stiffest machine a job can state; where none is stated only the cutter bends.
const RIGID: Machine =
    Machine { stiffness_x: Real::from_int(1_000_000), stiffness_y: Real::from_int(1_000_000), stated: true };

/// What a length without a point may be.
pub const DECIMALS: [(&str, PointlessLength); 2] =
    [("calculator", PointlessLength::Calculator), ("least", PointlessLength::Least)];

/// How the centres of arcs may count.
const ARC_CENTRES: [(&str, ArcCentres); 2] =
    [("incremental", ArcCentres::Incremental), ("absolute", ArcCentres::Absolute)];

impl JobFile {
    /// Reads and checks a job file.
    ///
    /// # Errors
    /// An [`InputError`] at the first thing that is wrong.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::parse(Source::read(path)?, folder)
    }

    /// Checks the text of a job whose relative paths start at `folder`.
    ///
    /// # Errors
    /// An [`InputError`] at the first thing that is wrong.
    pub fn parse(source: Source, folder: &Path) -> Result<Self, InputError> {
        job(source, folder)
    }
}

/// Reads the whole job. What it does not say and the program does, is read there; the rest has a stated default.
fn job(source: Source, folder: &Path) -> Result<JobFile, InputError> {
    let table = notation::parse(&source, "the job file")?;
    let (spans, nothing) = (RefCell::new(Spans::new()), DeTable::new());
    let root = Section::root(&source, &table, &spans);
    notation::version(&source, &root)?;
    let program = root.text("program")?.ok_or_else(|| root.missing("program", "the file name of a G-code program"))?;
    if program.0.is_empty() {
        return Err(root.out_of_range(
            &program.1,
            "the file name of a G-code program",
            "name the program, relative to this file",
        ));
    }
    let wall = root.choice("wall", &[("left", Side::Left), ("right", Side::Right)])?;
    let path = folder.join(program.0);
    let open = Open::new(&path);
    let mut assumed = Vec::new();
    let stated_dialect = root.choice("dialect", &DIALECTS)?;
    let dialect = stated_dialect.unwrap_or_else(|| open.dialect(&mut assumed));
    let decimal = root.choice("decimal", &DECIMALS)?.unwrap_or_default();
    let arc_centres = root.choice("arc_centres", &ARC_CENTRES)?.unwrap_or_default();
    let tool_section = match root.section("tool")? {
        Some(section) => section,
        None if open.names_mill() => root.section_of("tool", &nothing),
        None => return Err(root.missing_section("tool", "diameter_mm and teeth")),
    };
    let life = "count the parts that this cutter had cut before the first one that is learned from";
    let parts_cut = tool_section.whole("parts_cut", Limits::within("0", "100000", ""), life)?.unwrap_or(0);
    let (tool, shank, cutters) = tool(&source, &tool_section, folder, &open, &mut assumed)?;
    let features = features(&source, &root, tool.diameter)?;
    let pocket = root.section("pocket")?.map(|section| pocket(&section)).transpose()?;
    let stock = match root.section("stock")? {
        // A slot is cut at full immersion: there is no allowance to state.
        None if pocket.is_some_and(|p| p.mode == Mode::Slot) => Stock::of_a_slot(tool.diameter),
        _ => stock(&root.required_section("stock", "allowance_mm")?, tool.diameter)?,
    };
    let (cut, deep) = match root.section("cut")? {
        Some(section) => cut(&section, &open)?,
        None if open.is_readable() => (UNKNOWN_CUT, false),
        None => return Err(root.missing_section("cut", "axial_depth_mm")),
    };
    if deep {
        reach(&source, &tool_section, (&tool, &shank), &cut)?;
    }
    let force = match root.section("force")? {
        Some(section) => force(&source, &section, folder, &open, &mut assumed)?,
        None => open.force(None, &mut assumed),
    };
    let read = root.section("probe")?.map(|section| probe(&source, &section, &mut assumed)).transpose()?;
    let (probe, format_stated) = read.map_or((None, false), |(probe, stated)| (Some(probe), stated));
    let (machine, play) = match root.section("machine")? {
        // Without a probe a pocket may be compensated for the cutter alone.
        None if pocket.is_some() && probe.is_none() => (RIGID, Play::default()),
        Some(section) => machine(&section, &mut assumed)?,
        None => (usual_machine(&mut assumed), Play::default()),
    };
    let depth = deep.then_some(cut.axial_depth);
    let (correct, writing) = correct(&source, root.section("correct")?.as_ref(), depth)?;
    let feed = feed(root.section("feed")?.as_ref())?;
    let (plan, plan_cutters) = plan(root.section("plan")?.as_ref(), &tool)?;
    let part = part(root.section("part")?.as_ref())?;
    let mut store = store(&source, root.section("store")?.as_ref(), folder)?;
    if store.names.material.is_none() {
        let of_force = root.section("force")?.map(|section| section.text("material")).transpose()?.flatten();
        store.names.material = of_force.map(|(name, _)| name.to_owned());
    }
    root.close()?;
    let (program, unit) = (path, root.unit());
    let Stock { allowance, surface, probe: stock_probe, roughing } = stock;
    let [surface, stock_probe] = [surface, stock_probe].map(|name| name.map(|name| folder.join(name)));
    drop(root);
    Ok(JobFile {
        program,
        numbers: truepath_core::job::Job {
            dialect,
            decimal,
            arc_centres,
            wall,
            allowance,
            tool,
            cut,
            force,
            machine,
            probe,
            correct,
            part: None,
        },
        backlash: play.backlash,
        repeatability: play.repeatability,
        tolerance: writing.tolerance,
        max_arc_radius: writing.max_arc_radius,
        max_kink_deg: writing.max_kink_deg,
        discrepancy: writing.discrepancy,
        route: writing.route,
        feed,
        plan,
        plan_cutters,
        part,
        store,
        pocket,
        shank,
        parts_cut,
        surface,
        stock_probe,
        roughing,
        features,
        which: Which::default(),
        drawn: false,
        assumed,
        cutters,
        open_depth: !deep,
        format_stated,
        probe_control: open.probe_control(stated_dialect),
        signer: None,
        force_data: false,
        unit,
        spans: spans.into_inner(),
        source: source.clone(),
    })
}

/// A cut of which nothing is said; the depth is found with the contour.
const UNKNOWN_CUT: Cut = Cut { axial_depth: Offset::from_um(1_000), spindle_rpm: None, feed_mm_per_min: None };

/// Depth and speeds, and whether the depth is among them.
fn cut(section: &Section<'_>, open: &Open) -> Result<(Cut, bool), InputError> {
    const DEPTH: Limits = Limits::above("0", "200", "mm");
    let depth = match section.number("axial_depth_mm", DEPTH)? {
        None if open.is_readable() => None,
        None => Some(section.required_number("axial_depth_mm", DEPTH)?.as_mm()),
        Some(depth) => Some(depth.as_mm()),
    };
    let spindle_rpm = section.number("spindle_rpm", Limits::within("1", "200000", "rev/min"))?.map(Decimal::as_real);
    let feed_mm_per_min =
        section.number("feed_mm_per_min", Limits::within("0.1", "100000", "mm/min"))?.map(Decimal::as_real);
    section.close()?;
    let axial_depth = depth.unwrap_or(UNKNOWN_CUT.axial_depth);
    Ok((Cut { axial_depth, spindle_rpm, feed_mm_per_min }, depth.is_some()))
}

fn force(
    source: &Source,
    section: &Section<'_>,
    folder: &Path,
    open: &Open,
    assumed: &mut Vec<Assumed>,
) -> Result<Force, InputError> {
    const MODELS: [(&str, ForceModel); 3] =
        [("auto", ForceModel::Auto), ("helical", ForceModel::Helical), ("mean", ForceModel::Mean)];
    const KEYS: [&str; 4] = ["ktc_n_per_mm2", "krc_n_per_mm2", "kte_n_per_mm", "kre_n_per_mm"];
    let stated_model = section.choice("model", &MODELS)?;
    let model = stated_model.unwrap_or(ForceModel::Auto);
    if let Some((name, place)) = section.text("from")? {
        let others = ["material", KEYS[0], KEYS[1], KEYS[2], KEYS[3]];
        if let Some(value) = others.into_iter().find_map(|key| section.value(key)) {
            let found = format!("{} is given as well as force.from", value.path);
            let help = "remove from, or what it takes the place of";
            return Err(section.contradiction(&value, &found, "measured coefficients or other ones", help));
        }
        section.close()?;
        let read = |root: &Section<'_>| {
            coefficients(
                &root.required_section("force", "the four coefficients, as truepath forces writes them")?,
                model,
            )
        };
        return measured::read(source, place.span, &folder.join(name), read);
    }
    let materials: Vec<(&str, usize)> = MATERIALS.iter().enumerate().map(|(i, m)| (m.name, i)).collect();
    let Some(index) = section.choice("material", &materials)? else {
        if KEYS.iter().all(|key| section.value(key).is_none()) {
            section.close()?;
            return Ok(open.force(stated_model, assumed));
        }
        let force = coefficients(section, model)?;
        section.close()?;
        return Ok(force);
    };
    if let Some(value) = KEYS.into_iter().find_map(|key| section.value(key)) {
        let found = format!("{} is given as well as force.material", value.path);
        let help = "remove material to use your own coefficients, or remove the coefficients";
        return Err(
            InputError::new(J008, found, "either a material or the four coefficients", help).at(source, value.span)
        );
    }
    section.close()?;
    let [ktc, krc, kte, kre] =
        MATERIALS[index].coefficients.map(|text| Decimal::parse(text).map_or(Real::ZERO, Decimal::as_real));
    Ok(Force { ktc, krc, kte, kre, model, stated: true })
}

/// The four coefficients, all of which must be there.
fn coefficients(section: &Section<'_>, model: ForceModel) -> Result<Force, InputError> {
    let edge = Limits::within("0", "500", "N/mm");
    Ok(Force {
        ktc: section.required_number("ktc_n_per_mm2", Limits::above("0", "20000", "N/mm²"))?.as_real(),
        krc: section.required_number("krc_n_per_mm2", Limits::within("0", "20000", "N/mm²"))?.as_real(),
        kte: section.required_number("kte_n_per_mm", edge)?.as_real(),
        kre: section.required_number("kre_n_per_mm", edge)?.as_real(),
        model,
        stated: true,
    })
}

/// What a machine does beside yielding.
#[derive(Clone, Copy, Debug, Default)]
struct Play {
    /// Of x and y.
    backlash: [Offset; 2],
    /// From part to part, where it is stated.
    repeatability: Option<Offset>,
}

/// Stiffness, the backlash of both axes, and what it repeats to.
fn machine(section: &Section<'_>, assumed: &mut Vec<Assumed>) -> Result<(Machine, Play), InputError> {
    const KEYS: [&str; 2] = ["stiffness_x_n_per_mm", "stiffness_y_n_per_mm"];
    let stiffness = Limits::within("10", "1000000", "N/mm");
    let machine = if KEYS.iter().all(|key| section.value(key).is_none()) {
        usual_machine(assumed)
    } else {
        Machine {
            stiffness_x: section.required_number(KEYS[0], stiffness)?.as_real(),
            stiffness_y: section.required_number(KEYS[1], stiffness)?.as_real(),
            stated: true,
        }
    };
    let backlash = |key| {
        let number = section.number(key, Limits::within("0", "1", "mm"))?;
        Ok::<_, InputError>(number.map_or(Offset::ZERO, Decimal::as_mm))
    };
    let backlash = [backlash("backlash_x_mm")?, backlash("backlash_y_mm")?];
    let repeatability = section.number("repeatability_mm", Limits::within("0.0001", "0.5", "mm"))?.map(Decimal::as_mm);
    section.close()?;
    Ok((machine, Play { backlash, repeatability }))
}
