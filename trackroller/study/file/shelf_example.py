"""The shelf with which a user starts: of `trackroller shelf --example`."""

EXAMPLE = """\
# Rollers for a round rail of 12 mm. Every value is made up: write those of your catalogue page.
# A row is a roller. A unit stands at the head of its column. An empty cell takes the value of the
# case. Columns that you do not need may be left out.
# axis_distance: from the axis of the roller to that of the rail; or outer_radius and groove_depth.
# roller_profile_radius: radius of the groove, below 0. contact_angle: of both contacts.
# Further columns: catalogue_radial_force [N], catalogue_axial_force [N], catalogue_basic_life [km],
# catalogue_law (dry, lubricated or cubic); bearing_dynamic_rating [N] and the other keys of
# bearing; stud_diameter [mm], stud_length [mm], stud_yield_strength [MPa]; any of your own.
# Check them: trackroller shelf FILE --case case.yaml
# Find one: trackroller size case.yaml --shelf FILE --life "3 years" --safety 1.5 --least price
name;axis_distance [mm];roller_profile_radius [mm];contact_angle [deg];roller_material;price [EUR]
small;16;-6.5;30;1.7225-quenched-tempered;9.50
medium;21.75;-6.5;30;1.7225-quenched-tempered;12.80
large;30;-6.6;30;1.7225-quenched-tempered;18.40
"""
