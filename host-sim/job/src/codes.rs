//! Errors of the job, of its features and of what it names.

truepath_ground::codes! {
    J001 => "a file named by the job cannot be read"
        / "correct the name: it is taken relative to the job file's folder",
    J009 => "stock that was measured is for the host only: a device that computes its own image takes an even allowance"
        / "make the image here, with truepath correct --route coprocessor, and upload it",
    K001 => "the surface of the stock is no table of points"
        / "write a first line x_mm,y_mm and then one point of the surface a line, decimal points, in the order of travel",
    J027 => "the path under G41 or G42 may be the part's outline or that of the cutter's centre"
        / "write compensation = \"radius\" in [tool] when D holds the cutter's radius (the outline), \"centre\" when it holds wear or nothing",
    J040 => "the program does not show how deep the cutter is in the stock"
        / "write axial_depth_mm in [cut]: from the top of the stock, or from the level cut before, down to the cutter's tip",
    J041 => "several cutters of the program may make the contour"
        / "write number in [tool], or diameter_mm: the cutter that makes the wall to be corrected",
    J042 => "what the program does not say and no default can stand for"
        / "say it with --set, or answer on a terminal; --yes takes the defaults of what has one",
    J043 => "a probe file of no known format, and a job that names none"
        / "write format in [probe], or --format: docs/probe-formats.md shows each of them",
    J044 => "a probe file in UTF-16"
        / "save it as UTF-8 or as plain text (in Windows: save as, encoding UTF-8), and give it again",
    J045 => "a password in a job"
        / "take it out of the URL: PGPASSFILE, ~/.pgpass or PGPASSWORD give it to whoever may have it",
    K002 => "the surface of the stock does not lie along the contour, or not between wall and cutter"
        / "check frame and unit of the surface, and that it belongs to this program",
    M040 => "more probe points than are taken at once"
        / "keep every n-th reading of a scan: some places on each wall and in every corner, each at several heights, tell all there is; truepath inspect takes the whole file",
    M042 => "the probe file is of another format than the job says"
        / "write the format that the error names into [probe] of the job, or give it with --format",
    M043 => "a dimension without its value"
        / "measure it and type the number, or take the whole [[dimension]] out of the file",
    M044 => "a dimension along Z"
        / "take it out of the file: a depth or a step is not of the wall, and nothing here corrects Z",
    M045 => "no wall of this cut where a dimension was measured"
        / "look at the coordinate, at along and at the origin: coordinates are those of the program",
    M046 => "a dimension across a wall that is not square to it"
        / "measure where the wall is square to X or Y, or touch that wall with a probe",
    M047 => "a dimension far from what the program leaves"
        / "look whether value, place and job are of one part, and read the instrument again",
    M048 => "a dimension above or below the cut"
        / "give the height at which the jaws touched the wall, in coordinates of the program (z_mm) or above the tip (height_mm)",
    M049 => "a dimension that fits several places"
        / "add near_mm, a coordinate along the axis between the two walls that were measured",
    M050 => "results of a measuring machine without what is asked of them"
        / "give a Q-DAS file (.dfq) with a characteristic of this name (K2002) or number (K2001), in mm, and a value",
    M051 => "a height above the tip between two contours that are cut to different depths"
        / "give the height in program coordinates: z_mm in place of height_mm",
    M052 => "no QIF 3 document with results"
        / "export results as QIF 3.0 from the measuring machine, as XML in UTF-8, and give that file as it is",
    M053 => "a QIF document without what is asked of it"
        / "export measured points with their coordinates, in work coordinates of the program; or name the document in a file of [[dimension]] tables, values = \"part.qif\", which say where each length was measured",
    K004 => "touches of the stock that lie on the finished wall"
        / "touch the stock before the finishing pass, with the program that truepath probe --stock writes, and name that file in stock.probe",
    K005 => "too few touches of the stock"
        / "touch it at more places, spread along the whole contour: truepath probe --stock writes the program",
    K006 => "touches that are not of the stock of this contour"
        / "check that the file is of this part before its finishing pass, in the work coordinates of its program, and allowance_mm in the job",
    K008 => "roughing of the program that does not leave the stock of this pass"
        / "correct stock.roughing_diameter_mm or stock.roughing_tool, or leave both out: the stock is then even",
    K020 => "a file that should hold keys and does not"
        / "give a file that truepath key new wrote",
    K021 => "a public key where a private one belongs, or the other way round"
        / "the private key is the file named to truepath key new, the public one beside it ends with .pub",
    K022 => "a private key that others can read"
        / "chmod 600 it, and make a new pair if somebody may have seen it",
    K023 => "a time to sign at that is none"
        / "SOURCE_DATE_EPOCH is whole seconds since 1970, up to 4294967295: unset it, or name --counter",
    N001 => "several features can be corrected, and none is named"
        / "add --feature and one of these names; each of them is a correction of its own",
    N002 => "no feature of that name"
        / "name one of those the error lists",
    N003 => "a marker BEGIN inside another feature"
        / "features do not nest: end one before the next",
    N004 => "a marker END without its BEGIN or of another name, or a comment that only begins like a marker"
        / "write (TRUEPATH BEGIN id) before the cut and (TRUEPATH END) behind it",
    N005 => "a marker BEGIN without its END"
        / "add (TRUEPATH END) behind the last block of the feature",
    N006 => "a name used by two markers"
        / "give every feature a name of its own",
    N007 => "a feature without a place in the program, or markers of a feature that the job does not have"
        / "give the feature blocks, lines or markers, or remove the markers",
    N008 => "a block number that the program does not have, or has several times"
        / "write lines = [first, last] with line numbers, or put markers into the program",
    N009 => "heights of passes that differ from those of the program"
        / "give one height for every pass along this wall, in program coordinates, or leave z_mm out",
    N010 => "several finishing contours in one feature"
        / "name the lines of the cut with [[feature]] in the job, or with markers in the program",
    N011 => "nothing to correct: no cut of the tool, or a role that is not corrected"
        / "name a feature with role = \"finish\", its tool and its place",
    N012 => "no pass of that number"
        / "passes are the depths of the feature in the order of the program",
}
