within ;
model PantographUnderLine "Both FMUs, with the wire as an affine map of the contact force: as if solved as one"
  // Catenary_fmu and ZSpringPantograph_fmu are the classes that the import of the FMUs of `zspring export --flat` makes
  // (as in Dymola, for co-simulation): all of their variables are Reals, and no name has a dot.
  parameter Real step(unit = "s") = 0.001 "Communication step of both";
  parameter Real speed(unit = "m/s") = 250/3.6;
  parameter Real staticForce(unit = "N") = 120 "That of the pantograph, static_force";
  Catenary_fmu catenary(fmi_CommunicationStepSize = step, exchange = 3 "Parallel", exchange_step = step,
    pantograph_1_start = 60, pantograph_1_static_force = staticForce);
  ZSpringPantograph_fmu pantograph(fmi_CommunicationStepSize = step, drive = 3 "Wire");
equation
  pantograph.wire_height = catenary.pantograph_1_free_height;
  pantograph.wire_compliance = catenary.pantograph_1_compliance;
  pantograph.wire_compliance_previous = catenary.pantograph_1_compliance_previous;
  catenary.pantograph_1_force = pantograph.contact_force_out;
  catenary.pantograph_1_speed = speed;
  annotation(experiment(StopTime = 7, Interval = 0.001));
end PantographUnderLine;
