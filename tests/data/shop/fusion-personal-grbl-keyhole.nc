(Schluesselloch)
(T1 D=4 CR=0 - ZMIN=-6 - flat end mill)
G90 G94
G17
G21

(When using Fusion for Personal Use, the feedrate of rapid)
(moves is reduced to match the feedrate of cutting moves,)
(which can increase machining time. Unrestricted rapid moves)
(are available with a Fusion Subscription.)
G28 G91 Z0
G90

(2D Kontur1)
M3 S20000
G54
G0 X2.4 Y20.4
Z15
G1 Z5 F1000
Z1 F333
Z-6
G3 X2 Y20 I0 J-0.4 F1000
G1 Y5
G3 X5 Y2 I3 J0
G1 X35
G3 X38 Y5 I0 J3
G1 Y9
G2 X43 Y14 I5 J0
G1 X55
G3 X58 Y17 I0 J3
G1 Y23
G3 X55 Y26 I-3 J0
G1 X43
G2 X38 Y31 I0 J5
G1 Y35
G3 X35 Y38 I-3 J0
G1 X5
G3 X2 Y35 I0 J-3
G1 Y20
Y19
G3 X2.4 Y18.6 I0.4 J0
G1 Z15
M5
G28 G91 Z0
G90
G28 G91 X0 Y0
G90
M30
