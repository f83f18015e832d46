( Made using CamBam - http://www.cambam.co.uk )
( bearing seat 2/11/2024 7:40:03 AM )
( T3 : 0.375 )
G20 G90 G64 G40
G0 Z0.25
( T3 : 0.375 )
T3 M6
( Pocket2 )
G17
M3 S3500
G0 X2.625 Y1.5
G0 Z0.05
G1 F6. Z-0.2
G3 F14. X1.375 I-0.625 J0.
X2.625 I0.625 J0.
G1 F6. Z-0.4
G3 F14. X1.375 I-0.625 J0.
X2.625 I0.625 J0.
G0 Z0.25
M5
M30
