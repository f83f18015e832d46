//! Wrong files, and what is said of them.

use truepath_plant::Dynamometer;

use crate::recovered::{RECORD, Records};

fn code(text: &str, records: &Records) -> (String, String) {
    let error = records.analysis(text).expect_err("an error");
    (error.code().to_owned(), error.to_json().to_string())
}

#[test]
fn wrong_descriptions_are_refused_with_what_to_do() {
    let records = Records::new(9000, &Dynamometer::default());
    let good = records.described(RECORD, 3);
    // The axes: swapped, turned, not said.
    let (c, said) = code(&good.replace("feed = \"Fx\"\nacross = \"Fy\"", "feed = \"Fy\"\nacross = \"Fx\""), &records);
    assert!(c == "E006" && said.contains("feed = \\\"-Fx\\\", across = \\\"-Fy\\\""), "{said}");
    assert_eq!(code(&good.replace("\"workpiece\"", "\"tool\""), &records).0, "E006");
    // The unit, either way.
    let (c, said) = code(&good.replace("repeatability", "unit = \"kN\"\nrepeatability"), &records);
    assert!(c == "E007" && said.contains("unit = \\\"N\\\""), "{said}");
    // Tool data, revolutions, columns, rate.
    assert_eq!(code(&good.replace("helix_deg = 35\n", ""), &records).0, "J004");
    assert_eq!(code(&good.replace("axial_depth_mm = 6\n", ""), &records).0, "E008");
    assert_eq!(code(&good.replace("milling = \"down\"\n", ""), &records).0, "E008");
    assert_eq!(
        code(&good.replace("record = \"0.csv\"", "record = \"0.csv\"\nfrom_s = 0.5\nto_s = 0.51"), &records).0,
        "E005"
    );
    assert_eq!(code(&good.replace("\"Fx\"", "\"Fq\""), &records).0, "E002");
    assert_eq!(code(&good.replace("0.csv", "none.csv"), &records).0, "F001");
    std::fs::write(records.folder().join("0.csv"), "Fx,Fy\n1,2\n3,4\n").expect("a file");
    assert_eq!(code(&good, &records).0, "E003");
    std::fs::write(records.folder().join("0.csv"), "Fx,Fy\n1,2\n3,x\n").expect("a file");
    assert_eq!(code(&good, &records).0, "E001");
}

#[test]
fn of_eight_ways_to_name_the_columns_seven_are_refused_at_every_engagement() {
    let side = |sign: bool, column: &str| format!("{}{column}", if sign { "" } else { "-" });
    let mut wrong = Vec::new();
    for (k, radial_depth_mm) in [1.0, 4.5, 8.0, 12.0].into_iter().enumerate() {
        for down in [true, false] {
            let records = Records::engaged(radial_depth_mm, down, 9100 + k as u64, &Dynamometer::default());
            let good = records.described(RECORD, 3);
            for (first, second) in [("Fx", "Fy"), ("Fy", "Fx")] {
                for (feed, across) in [(true, true), (true, false), (false, true), (false, false)] {
                    let axes = format!("feed = \"{}\"\nacross = \"{}\"", side(feed, first), side(across, second));
                    let told = records.analysis(&good.replace("feed = \"Fx\"\nacross = \"Fy\"", &axes));
                    let fits = match &told {
                        Ok(_) => first == "Fx" && feed && across,
                        // Forces on the tool are those on the workpiece turned.
                        Err(error) => {
                            error.code() == "E006"
                                && error.to_json().to_string().contains("feed = \\\"-Fx\\\", across = \\\"-Fy\\\"")
                        }
                    };
                    if !fits {
                        let said = told.map_or_else(|error| error.to_json().to_string(), |_| "taken".to_owned());
                        wrong.push(format!("{radial_depth_mm} mm, down {down}, {axes}: {said}"));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn where_a_thin_cut_does_not_tell_the_axes_apart_it_is_said() {
    let records = Records::engaged(0.3, true, 9003, &Dynamometer::default());
    let warned = |text: &str| {
        let analysis = records.analysis(text).expect("an analysis");
        analysis.warnings.iter().any(|w| w.contains("whether the columns are named right is not told"))
    };
    let good = records.described(RECORD, 3);
    assert!(warned(&good));
    assert!(warned(&good.replace("feed = \"Fx\"\nacross = \"Fy\"", "feed = \"Fy\"\nacross = \"Fx\"")));
}

#[test]
fn one_feed_is_told() {
    let records = Records::new(9001, &Dynamometer::default());
    let analysis = records.analysis(&records.described(RECORD, 1)).expect("an analysis");
    assert!(analysis.warnings.iter().any(|w| w.starts_with("one feed only")), "{:?}", analysis.warnings);
}

#[test]
fn another_speed_and_another_number_of_teeth_are_told() {
    let records = Records::new(9002, &Dynamometer::default());
    let good = records.described(RECORD, 2);
    for (wrong, said) in [
        (good.replace("spindle_rpm = 4200", "spindle_rpm = 5300"), "a speed other than 5300 rev/min"),
        (good.replace("teeth = 4", "teeth = 3"), "another number of teeth than 3"),
    ] {
        let warnings = records.analysis(&wrong).expect("an analysis").warnings;
        assert!(warnings.iter().filter(|warning| warning.contains(said)).count() == 2, "{said}: {warnings:?}");
    }
    let warnings = records.analysis(&good).expect("an analysis").warnings;
    assert!(!warnings.iter().any(|w| w.contains("speed other") || w.contains("number of teeth")), "{warnings:?}");
}
