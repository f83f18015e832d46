/** The identified parameters in the words of a workshop, by the names the program gives them. */

export const MEANING: Record<string, string> = {
  compliance: "how far machine and cutter give way to a newton, mean of X and Y",
  compliance_difference: "half of what X gives way more than Y",
  compliance_cross: "how far Y gives way under a force along X, and X under one along Y",
  radial_ratio: "of the chip's force, the part away from the wall over the part along the cut",
  edge_level: "force of the rubbing edges over what the job states: wear raises it",
  edge_ratio: "the same of the force of the rubbing edges",
  bend: "how much farther the tip of the cutter moves than its section at the top of the cut, as a share",
  size_exponent: "how much more force thin chips take for their area than thick ones; 0: none",
  undersize: "how much smaller than stated the cutter cuts, on the radius",
  datum_x: "shift of the part along X between cutting and probing",
  datum_y: "shift of the part along Y between cutting and probing",
};
