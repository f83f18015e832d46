//! scratch harness
use std::path::Path as FilePath;
use truepath_correction::correction::identify;
use truepath_correction::misfit::{Look, judged};
use truepath_ground::diagnostics::Source;
use truepath_job::job::JobFile;
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};
use truepath_study::case::Case;
use truepath_study::draw::Draw;
use truepath_study::families::FAMILIES;
use truepath_trial::virtual_mill;

fn edit(text: &str, mut f: impl FnMut(usize, [f64; 3]) -> [f64; 3]) -> String {
    text.lines()
        .enumerate()
        .map(|(k, line)| {
            let v: Vec<f64> = line.split_whitespace().map(|t| t.parse().unwrap()).collect();
            let [x, y, z] = f(k, [v[0], v[1], v[2]]);
            format!("{x:.6} {y:.6} {z:.6} 0 0 0 0 0 0\n")
        })
        .collect()
}

fn key(job: &str, key: &str, value: impl Fn(f64) -> f64) -> String {
    job.lines()
        .map(|l| match l.split_once(" = ") {
            Some((k, v)) if k.trim() == key => {
                format!("{key} = {:.4}\n", value(v.split_whitespace().next().unwrap().parse().unwrap()))
                    .replace(if key == "teeth" { ".0000" } else { "@" }, "")
            }
            _ => format!("{l}\n"),
        })
        .collect()
}

#[test]
#[ignore = "scratch"]
fn figures() {
    let seeds: Vec<u64> = std::env::var("SEEDS").unwrap().split(',').map(|s| s.parse().unwrap()).collect();
    let wanted = std::env::var("FAM").unwrap_or_default();
    let honest_only = std::env::var("HONEST").is_ok();
    for seed in &seeds {
        for family in FAMILIES.iter().filter(|f| wanted.is_empty() || wanted.split(',').any(|w| w == f.name)) {
            let id = format!("{}/{seed}", family.name).parse().unwrap();
            let case = Case::draw(&id).unwrap();
            let mut chance = Draw::new("wrong", *seed);
            let u = chance.between(0.0, 0.03);
            let mut machine = case.machine.clone();
            if machine.runout_mm.is_empty() {
                machine.runout_mm = vec![0.0; case.pass.core.setup.teeth.into()];
            }
            for r in &mut machine.runout_mm {
                *r -= u;
            }
            let worn = virtual_mill::mill(&case.pass, &machine, None).unwrap();
            let Ok(honest) = case.probe(1, &worn, &case.places_mm) else {
                println!("{} {seed} no probe", family.name);
                continue;
            };
            let n = honest.lines().count();
            let job = case.job.clone();
            let mut kinds = vec![("honest".to_owned(), honest.clone(), job.clone())];
            let w = [chance.between(0.0, n as f64) as usize, chance.between(0.0, n as f64) as usize];
            let s = [chance.between(-0.8, 0.8), chance.between(-0.8, 0.8)];
            if n > 6 {
                kinds.push((
                    "wild2".into(),
                    edit(&honest, |k, [x, y, z]| {
                        let mut o = [x, y, z];
                        for i in 0..2 {
                            if k == w[i] {
                                o[0] += s[i];
                                o[1] -= s[1 - i];
                            }
                        }
                        o
                    }),
                    job.clone(),
                ));
            }
            if !honest_only {
                for d in [0.05, 0.1, 0.2, 0.5, 0.9] {
                    kinds.push((
                        format!("datum {d}"),
                        edit(&honest, |_, [x, y, z]| [x + 0.8 * d, y - 0.6 * d, z]),
                        job.clone(),
                    ));
                }
                for f in [0.1, 0.5, 2.0, 10.0] {
                    kinds.push((format!("allow {f}"), honest.clone(), key(&job, "allowance_mm", |v| v * f)));
                }
                for f in [0.5, 2.0] {
                    kinds.push((format!("teeth {f}"), honest.clone(), key(&job, "teeth", |v| (v * f).round())));
                }
                for f in [0.0, 2.0] {
                    kinds.push((format!("helix {f}"), honest.clone(), key(&job, "helix_deg", |v| (v * f).min(60.0))));
                }
                for d in [-0.1, 0.1, 0.5, -0.5] {
                    kinds.push((format!("ball {d}"), honest.clone(), key(&job, "ball_diameter_mm", |v| v + d)));
                }
                for f in [0.5, 2.0] {
                    kinds.push((format!("ball x{f}"), honest.clone(), key(&job, "ball_diameter_mm", |v| v * f)));
                }
                for d in [0.5, 2.0, -2.0] {
                    kinds.push((format!("z {d}"), edit(&honest, |_, [x, y, z]| [x, y, z + d]), job.clone()));
                }
                kinds.push(("inch".into(), edit(&honest, |_, p| p.map(|v| v / 25.4)), job.clone()));
                kinds.push((
                    "side".into(),
                    honest.clone(),
                    if job.contains("\"right\"") {
                        job.replace("\"right\"", "\"left\"")
                    } else {
                        job.replace("\"left\"", "\"right\"")
                    },
                ));
            }
            for (kind, text, job) in kinds {
                let src = |n: &str, t: &str| Source::new(n, t.as_bytes().to_vec());
                let pass = match JobFile::parse(src("job.toml", &job), FilePath::new(""))
                    .map_err(Into::into)
                    .and_then(|j| Pass::new(j, src("program.nc", &case.program)))
                {
                    Ok(p) => p,
                    Err(e) => {
                        println!("{} {seed} {kind}: JOB {}", family.name, e);
                        continue;
                    }
                };
                let file = src("probe.txt", &text);
                let m = match Measurement::read(&pass, &file) {
                    Ok(m) => m.taken_as_is(true),
                    Err(e) => {
                        println!("{} {seed} {kind}: READ {}", family.name, e.to_string().lines().next().unwrap_or(""));
                        continue;
                    }
                };
                let mut buffer = PathBuffer::default();
                let path = match pass.sample(&mut buffer) {
                    Ok(p) => p,
                    Err(e) => {
                        println!("{} {seed} {kind}: SAMPLE {e}", family.name);
                        continue;
                    }
                };
                let found = identify(&pass, &path, &m, |_| ()).unwrap();
                let t = std::time::Instant::now();
                let misfit = judged(&pass, &m, &found.core, &found.observations);
                let look = Look::of(&pass, &m, &found.core, &found.observations);
                let (unfit, all) = look.count();
                println!(
                    "{} {seed} {kind}: {} | {:.1} s, {} cost {:.0} un {unfit}/{all} lv {:.3}±{:.3} far {:.1} med {:.1} d {:.3} gain {:.0} left {:.0} {}",
                    family.name,
                    match &misfit {
                        None => "passed".to_owned(),
                        Some(m) => format!(
                            "STOP {:?} {:?}",
                            m.reason,
                            m.causes.iter().map(|t| (t.cause, t.score.cost.round())).collect::<Vec<_>>()
                        ),
                    },
                    t.elapsed().as_secs_f64(),
                    if look.is_doubtful() { "doubt" } else { "" },
                    look.score.cost,
                    look.level_mm[0],
                    look.level_mm[1],
                    look.farthest.1,
                    look.score.median,
                    look.shift.length_mm(),
                    look.shift.gain,
                    look.shift.left,
                    if misfit.is_some() && std::env::var("SAY").is_ok() {
                        misfit.unwrap().error(&pass, &m).to_string()
                    } else {
                        String::new()
                    }
                );
            }
        }
    }
}
