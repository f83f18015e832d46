//! Errors between bench and board.

truepath_ground::codes! {
    H001 => "a port, a socket or a file cannot be opened"
        / "check the name, the permissions, and that nobody else uses it",
    H002 => "the emulator or the firmware is missing"
        / "install or build what the error names",
    H003 => "the device does not answer"
        / "check cable, port and baud rate, and that the board is powered",
    H004 => "the device refuses a request"
        / "what to do follows from the reason that the device gives",
    H005 => "the device speaks another version"
        / "use firmware and program of the same version",
    H006 => "device and host differ"
        / "do not drive axes with this firmware; report it with the command line",
    H007 => "an option, or a file of setpoints, does not fit the bench"
        / "choose other --rate or --axes, or setpoints in program coordinates",
    H008 => "a run was stopped before its end"
        / "run it again to its end; a shorter run has a smaller --count",
    H009 => "a rule of the safety contract was broken under attack"
        / "do not drive axes with this version; report it with the seed",
}
