"""The carriage with which a user starts: of the live page, and of `trackroller carriage
--example`.
"""

EXAMPLE = """\
# A shuttle of 40 kg with an off-centre payload: four rollers with upright axes hold two rails between them.
# Places [x, y, z] are in mm from a point of your choice: x forward, y left, z up.
mass: {value: 40 kg, at: [0, 0, 60]}            # the empty carriage and its centre of gravity
payloads:
  - {value: 60 kg, at: [80, 0, 150]}
drive: {at: [0, 0, -20]}                        # where the force along the track acts
rollers:
  FL:                                           # front left
    at: [150, 40, 0]
    pushes: [0, -1, 0]                          # direction in which the roller presses on its rail
    x_R: [0, 0, 1]                              # its own axis
    kind: locating                              # carries axial load; a floating roller carries radial load only
    # The case of the roller, without its loads: the rollers below repeat these lines by *roller. The name of a case
    # file does too, as in roller: roller.yaml
    roller: &roller
      axis_distance: 30 mm                      # from the axis of the roller to that of a round rail
      guide_profile_radius: 8 mm                # of the rail
      roller_profile_radius: -8.4 mm            # of the groove: below 0
      contact_angle: 45 deg
      guide_curve_radius: inf                   # a straight rail
      roller_material: 1.7225-quenched-tempered # trackroller materials lists the names
      guide_material: 1.7225-quenched-tempered
      friction_coefficient: 0.15
      motor_force: 0
      guide_overrollings_per_hour: 60           # of a point of the rail
  FR: {at: [150, -40, 0], pushes: [0, 1, 0], x_R: [0, 0, 1], kind: locating, roller: *roller}
  RL: {at: [-150, 40, 0], pushes: [0, -1, 0], x_R: [0, 0, 1], kind: locating, roller: *roller}
  RR: {at: [-150, -40, 0], pushes: [0, 1, 0], x_R: [0, 0, 1], kind: locating, roller: *roller}
preload:
  - {pair: [FL, FR], force: 600 N}              # between the two, without any other load
  - {pair: [RL, RR], force: 600 N}
cases:                                          # load cases, with their shares of the travel
  - {name: start, share: 0.1, acceleration: 2 m/s2, speed: 0.5 m/s}
  - {name: curve, share: 0.2, speed: 1 m/s, curve_radius: 1.5 m} # a radius > 0 turns left
  - {name: run, share: 0.7, speed: 1 m/s}
duty: {hours_per_day: 16, days_per_year: 250}   # turns hours of travel into years
"""
