"""What reading SVG takes: XML by expat, style sheets and values by tinycss2 and cssselect2."""
