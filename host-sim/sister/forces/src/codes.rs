//! Errors of measured forces.

truepath_ground::codes! {
    E001 => "a record that cannot be read as columns of numbers"
        / "export it as text: DynoWare (File, Export), LabVIEW measurement (.lvm), or comma separated values",
    E002 => "a column that the record does not have"
        / "name the columns under [record] as the record names them",
    E003 => "a record without a sampling rate"
        / "add rate_hz under [record], or a column of time",
    E004 => "a unit that is not known"
        / "add unit = \"N\" or \"kN\" under [record]",
    E005 => "no whole revolution of the cutter"
        / "record longer, correct spindle_rpm, or correct from_s and to_s",
    E006 => "forces that no cut of this geometry makes: axes or signs"
        / "correct feed and across under [record]",
    E007 => "forces beyond those of any metal: the unit"
        / "correct unit under [record], or depth and feed of the cut",
    E008 => "a cut that is not described"
        / "add the keys that the error names",
    E009 => "too little to fit"
        / "measure two feeds per tooth at least, with the same cutter",
}
