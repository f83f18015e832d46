(Winkel)
(T4 D=8 CR=0 - ZMIN=-6 - flat end mill)
G90 G94
G17
G21

(When using Fusion for Personal Use, the feedrate of rapid)
(moves is reduced to match the feedrate of cutting moves,)
(which can increase machining time. Unrestricted rapid moves)
(are available with a Fusion Subscription.)
G28 G91 Z0
G90

(Bore1)
T4 M6
S9000 M3
G54
G0 X-25 Y-15
Z15
G1 Z5 F1000
Z1 F300
X-23
G3 X-27 Z-1 I-2 J0 F600
X-23 Z-3 I2 J0
X-27 Z-5 I-2 J0
X-23 Z-6 I2 J0
X-27 I-2 J0
X-23 I2 J0
G1 X-25
Z5 F1000
X25 Y15
Z1 F300
X27
G3 X23 Z-1 I-2 J0 F600
X27 Z-3 I2 J0
X23 Z-5 I-2 J0
X27 Z-6 I2 J0
X23 I-2 J0
X27 I2 J0
G1 X25
Z15 F1000

(2D Contour1)
X4 Y-33
Z5
Z-5 F300
Z-6
X0.8 F800
X0.8 Y-29.8
G3 X0 Y-29 I-0.8 J0
G1 X-35
G2 X-44 Y-20 I0 J9
G1 Y20
G2 X-35 Y29 I9 J0
G1 X35
G2 X44 Y20 I0 J-9
G1 Y-20
G2 X35 Y-29 I-9 J0
G1 X0
G3 X-0.8 Y-29.8 I0 J-0.8
G1 Z15 F1000
X0 Y0
M5
G28 G91 Z0
G90
G28 G91 X0 Y0
G90
M30
