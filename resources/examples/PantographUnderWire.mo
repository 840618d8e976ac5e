within ;
model PantographUnderWire "The pantograph FMU under a wire that gives way: explicit coupling in Modelica"
  // ZSpringPantograph_fmu is the class that the import of ZSpringPantograph.fmu makes (as in Dymola: co-simulation,
  // structured declaration of variables). Drive is Force, as the FMU has it at the start: the contact is here.
  parameter Real staticForce(unit = "N") = 120 "That of the FMU, static_force";
  parameter Real contactStiffness(unit = "N/m") = 50000;
  parameter Real wireStiffness(unit = "N/m") = 3000;
  parameter Real amplitude(unit = "m") = 0.02 "Of the wire's supports";
  parameter Real period(unit = "s") = 0.5 "Of a span";
  final parameter Real stiffness(unit = "N/m") = 1/(1/contactStiffness + 1/wireStiffness) "Of both in series";
  constant Real pi = 3.14159265358979;
  Real support(unit = "m") "Height of the wire's supports, 0 in the static state";
  Real force(unit = "N") "Contact force";
  ZSpringPantograph_fmu pantograph(fmi_CommunicationStepSize = 0.001);
equation
  support = amplitude*sin(2*pi*time/period)^3;
  // The head's height is that of the last communication point: no algebraic loop.
  force = max(0, staticForce + stiffness*(pantograph.head.z - support));
  pantograph.contact_force = force;
  annotation(experiment(StopTime = 2, Interval = 0.001));
end PantographUnderWire;
