import java.io.File;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.List;
import no.ntnu.ihb.fmi4j.FmiStatus;
import no.ntnu.ihb.fmi4j.SlaveInstance;
import no.ntnu.ihb.fmi4j.importer.fmi2.Fmu;

/**
 * Runs an FMU with FMI4j, step by step.
 *
 * Fmi4jRun FMU STEP INPUTS OUTPUTS NAME=VALUE...: a parameter is Real where its value has a point. INPUTS is a CSV
 * file with the values at the begin of each step; OUTPUTS has names in its only line, and their values at the end of
 * each step are added to it.
 */
public class Fmi4jRun {
    static void check(boolean done, String what) {
        if (!done) throw new IllegalStateException(what);
    }

    public static void main(String[] arguments) throws Exception {
        double step = Double.parseDouble(arguments[1]);
        List<String> given = Files.readAllLines(Path.of(arguments[2]));
        List<String> written = new ArrayList<>(Files.readAllLines(Path.of(arguments[3])));
        try (Fmu fmu = Fmu.from(new File(arguments[0])); SlaveInstance slave = fmu.asCoSimulationFmu().newInstance()) {
            for (String parameter : Arrays.asList(arguments).subList(4, arguments.length)) {
                String[] pair = parameter.split("=");
                long[] reference = references(slave, pair[0]);
                FmiStatus status = pair[1].contains(".")
                    ? slave.writeReal(reference, new double[] {Double.parseDouble(pair[1])})
                    : slave.writeInteger(reference, new int[] {Integer.parseInt(pair[1])});
                check(status == FmiStatus.OK, parameter);
            }
            check(slave.simpleSetup(), "start");
            long[] inputs = references(slave, given.get(0)), outputs = references(slave, written.get(0));
            double[] values = new double[outputs.length];
            for (int n = 1; n < given.size(); ++n) {
                double[] row = Arrays.stream(given.get(n).split(",")).mapToDouble(Double::parseDouble).toArray();
                check(slave.writeReal(inputs, row) == FmiStatus.OK, "inputs of step " + n);
                check(slave.doStep((n - 1) * step, step), "step " + n);
                check(slave.readReal(outputs, values) == FmiStatus.OK, "outputs of step " + n);
                String line = Arrays.toString(values);
                written.add(line.substring(1, line.length() - 1));
            }
            check(slave.terminate(), "end");
        }
        Files.write(Path.of(arguments[3]), written);
    }

    static long[] references(SlaveInstance slave, String names) {
        return slave.getModelVariables().getValueReferences(names.split(","));
    }
}
