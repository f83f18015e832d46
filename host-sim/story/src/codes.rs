//! Errors of packs.

truepath_ground::codes! {
    U001 => "a pack that cannot be read"
        / "ask for the file again: it is damaged, cut off, or was not written by truepath pack",
    U002 => "a pack with a name that leads out of its folder, or with what is no file"
        / "do not unpack it with another program either; ask for one that truepath pack wrote",
    U003 => "a pack beyond the limits"
        / "pack one part: its job and the folders that truepath correct and truepath learn wrote",
    U004 => "no story: a job, its program and a correction"
        / "name the folder that holds the job and what truepath correct wrote for it",
    U005 => "a file of the story is missing, or two could be meant"
        / "name a folder with all of them, and with nothing of another part",
    U006 => "without names and comments the files are read otherwise"
        / "write what the comments say (cutter, dialect, format) into the job, correct anew, and pack again; or leave --anonymous out",
}
