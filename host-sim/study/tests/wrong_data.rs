//! scratch harness
use truepath_correction::correction::identify;
use truepath_correction::misfit::{Score, Shift, Trial, Cause};
use truepath_ground::diagnostics::Source;
use truepath_ground::units::{float, mm};
use truepath_job::measurement::Measurement;
use truepath_job::pass::PathBuffer;
use truepath_study::case::Case;
use truepath_study::draw::Draw;
use truepath_study::families::FAMILIES;
use truepath_trial::virtual_mill;

fn edit(text: &str, mut f: impl FnMut(usize, [f64; 3]) -> [f64; 3]) -> String {
    text.lines().enumerate().map(|(k, line)| {
        let v: Vec<f64> = line.split_whitespace().map(|t| t.parse().unwrap()).collect();
        let [x, y, z] = f(k, [v[0], v[1], v[2]]);
        format!("{x:.6} {y:.6} {z:.6} 0 0 0 0 0 0\n")
    }).collect()
}

#[test]
#[ignore = "scratch"]
fn figures() {
    let seeds: Vec<u64> = std::env::var("SEEDS").unwrap().split(',').map(|s| s.parse().unwrap()).collect();
    println!("family,seed,kind,n,lost,rms,median,cost,unfit5,unfit8,u,theta_max,dx,dy,sx,sy,gain,left,tdx,tdy,tcost,trms,stated");
    for family in FAMILIES {
        for seed in &seeds {
            let id = format!("{}/{seed}", family.name).parse().unwrap();
            let case = Case::draw(&id).unwrap();
            let mut chance = Draw::new("wrong", *seed);
            let u = chance.between(0.0, 0.03);
            let mut machine = case.machine.clone();
            if machine.runout_mm.is_empty() { machine.runout_mm = vec![0.0; case.pass.core.setup.teeth.into()]; }
            for r in &mut machine.runout_mm { *r -= u; }
            let worn = virtual_mill::mill(&case.pass, &machine, None).unwrap();
            let honest = case.probe(1, &worn, &case.places_mm).unwrap();
            let n = honest.lines().count();
            let mut kinds = vec![("honest", honest.clone())];
            let w = [chance.between(0.0, n as f64) as usize, chance.between(0.0, n as f64) as usize];
            let s = [chance.between(-0.8, 0.8), chance.between(-0.8, 0.8)];
            kinds.push(("wild2", edit(&honest, |k, [x, y, z]| { let mut o = [x, y, z]; for i in 0..2 { if k == w[i] { o[0] += s[i]; o[1] -= s[1 - i]; } } o })));
            for (name, d) in [("d0.05", 0.05), ("d0.1", 0.1), ("d0.2", 0.2), ("d0.5", 0.5)] {
                kinds.push((name, edit(&honest, |_, [x, y, z]| [x + 0.8 * d, y - 0.6 * d, z])));
            }
            for (kind, text) in kinds {
                let file = Source::new("probe.txt", text.into_bytes());
                let m = match Measurement::read(&case.pass, &file) { Ok(m) => m, Err(e) => { println!("{},{seed},{kind},{}", family.name, e.to_string().lines().next().unwrap_or("")); continue } };
                let mut buffer = PathBuffer::default();
                let path = case.pass.sample(&mut buffer).unwrap();
                let Ok(found) = identify(&case.pass, &path, &m, |_| ()) else { println!("{},{seed},{kind},M020", family.name); continue };
                let lost = m.rejected.len();
                let sc = Score::of(found.fit(), &found.observations, lost);
                let sh = Shift::of(found.prior(), found.fit(), &found.observations);
                let theta = found.fit().theta.map(float);
                let most = theta[..8].iter().fold(0f64, |a, b| a.max(b.abs()));
                let unfit = |l: f64| found.observations.iter().filter(|o| truepath_correction::misfit::residual_mm(o).abs() > l * truepath_correction::misfit::expected_mm(o)).count();
                let (t, st) = if std::env::var("TRIAL").is_ok() { (Trial::of(Cause::Datum([0.0; 2]), &case.pass, &m, found.law()), Trial::of(Cause::Nothing, &case.pass, &m, found.law())) } else { (None, None) };
                let td = t.as_ref().map_or([0.0; 2], |t| match t.cause { Cause::Datum(d) => d, _ => [0.0; 2] });
                println!("{},{seed},{kind},{},{lost},{:.4},{:.1},{:.0},{},{},{:.4},{most:.1},{:.3},{:.3},{:.3},{:.3},{:.0},{:.0},{:.3},{:.3},{:.0},{:.4},{:.0}", family.name, sc.points, sc.rms_mm, sc.median, sc.cost, unfit(5.0), unfit(8.0),
                    mm(found.fit().parameters.undersize), sh.datum_mm[0], sh.datum_mm[1], sh.sigma_mm[0], sh.sigma_mm[1], sh.gain, sh.left, td[0], td[1], t.as_ref().map_or(0.0, |t| t.score.cost), t.as_ref().map_or(0.0, |t| t.score.rms_mm), st.as_ref().map_or(0.0, |t| t.score.cost));
            }
        }
    }
}
