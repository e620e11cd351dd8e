/* Cost of the 3D wire on one core: the solid cylinder of type 3 (720 hexahedra, loading to 53 mm,
 * unloading to zero force). The baseline is CalculiX on the same mesh and history if `ccx` is
 * installed (Debian: calculix-ccx; a run takes some minutes), otherwise its stored CPU time. A
 * second part shows time and memory over the number of elements along the wire: both should grow
 * linearly. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "base/units.h"
#include "fe/solid/solid.h"
#include "fe/trial/wire3d.h"
#include "tests/bench/clock.h"

/* CPU seconds of CalculiX 2.20 on one 2.6 GHz Zen 4 core, 720 C3D20R. */
static const double stored_ccx = 249.0;

struct cost {
    double cpu; /* s */
    int elements, unknowns, iterations;
    double tension, residual; /* N at 53 mm, m after unloading */
};

static bool read_model(struct wb_wire_model *model)
{
    char path[WB_PATH];
    if (wb_file_find_fixture(path, "models", "solid-cylinder-type3", NULL) != WB_OK ||
        wb_wire_model_read(model, path) != WB_OK)
        return false;
    model->step[0].rows = 18;
    model->step[1].rows = 4;
    return true;
}

static bool solve(const struct wb_wire_model *model, struct cost *cost)
{
    struct wb_wire3d *wire = NULL;
    struct wb_wire_run run = {0};
    const double start = cpu_seconds();
    const bool good = wb_wire3d_create(&wire, model) == WB_OK &&
                      wb_wire_run_init(&run, model, 7) == WB_OK &&
                      wb_wire3d_run(wire, &run, NULL) == WB_OK && run.converged;

    *cost = (struct cost){.cpu = cpu_seconds() - start};
    if (good) {
        cost->elements = run.n_elements;
        cost->unknowns = run.n_unknowns;
        cost->iterations = run.iterations;
        cost->tension = run.rows[model->step[0].rows].tension;
        cost->residual = run.rows[run.n_rows - 1].tip[1];
    }
    wb_wire_run_release(&run);
    wb_wire3d_destroy(wire);
    return good;
}

/* --- the same problem for CalculiX: N, mm, MPa, t --- */

static void write_mesh(FILE *deck, const struct wb_solid_mesh *mesh)
{
    fputs("*NODE,NSET=NALL\n", deck);
    for (int i = 0; i < mesh->n_nodes; i++)
        fprintf(deck, "%d,%.10g,%.10g,%.10g\n", i + 1, mesh->node[i][0] / WB_MM,
                mesh->node[i][1] / WB_MM, mesh->node[i][2] / WB_MM);
    fputs("*ELEMENT,TYPE=C3D20R,ELSET=EALL\n", deck);
    for (int e = 0; e < mesh->n_elements; e++) {
        fprintf(deck, "%d", e + 1);
        for (int k = 0; k < WB_SOLID_MESH_NODES; k++)
            fprintf(deck, ",%s%d", k == 10 ? "\n" : "", mesh->element[e][k] + 1);
        fputc('\n', deck);
    }
}

static void write_material(FILE *deck, const struct wb_wire_model_part *part)
{
    const struct wb_material *m = &part->material;
    const int n = 100;

    fprintf(deck, "*MATERIAL,NAME=M\n*ELASTIC\n%.9g,%.9g\n*DENSITY\n%.9g\n*PLASTIC\n%.9g,0\n",
            m->youngs_modulus / WB_MPA, m->poissons_ratio, part->density * 1e-12,
            m->yield_stress / WB_MPA);
    for (int i = 0; i < n; i++) {
        const double p = 1e-6 * pow(0.3 / 1e-6, (double)i / (n - 1));
        fprintf(deck, "%.9g,%.9g\n",
                (m->yield_stress + m->strength_coefficient * pow(p, m->hardening_exponent)) /
                    WB_MPA,
                p);
    }
    fputs("*SOLID SECTION,ELSET=EALL,MATERIAL=M\n", deck);
}

static void write_history(FILE *deck, const struct wb_solid_mesh *mesh)
{
    static const double targets[] = {1, 2, 5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 53, 43, 36};
    const int tip = mesh->axis[mesh->n_axis - 1] + 1;

    fputs("*BOUNDARY\n", deck);
    for (int i = 0; i < mesh->n_clamp; i++) {
        const int node = mesh->clamp[i];
        fprintf(deck, "%d,1,1\n", node + 1);
        for (int axis = 1; axis < 3; axis++)
            if (fabs(mesh->node[node][axis]) < 1e-12)
                fprintf(deck, "%d,%d,%d\n", node + 1, axis + 1, axis + 1);
    }
    fprintf(deck,
            "*NSET,NSET=TIP\n%d\n*STEP,NLGEOM,INC=100\n*STATIC\n.5,1.\n*DLOAD\n"
            "EALL,GRAV,9810.,0.,1.,0.\n*END STEP\n",
            tip);
    for (size_t i = 0; i < sizeof targets / sizeof targets[0]; i++)
        fprintf(deck,
                "*STEP,NLGEOM,INC=10000\n*STATIC\n1,%g,1e-6,2\n*BOUNDARY\n%d,2,2,%g\n"
                "*NODE PRINT,NSET=TIP,FREQUENCY=999999\nU,RF\n*END STEP\n",
                i == 0 ? 1.0 : fabs(targets[i] - targets[i - 1]), tip, targets[i]);
}

static double children_cpu(void)
{
    struct rusage usage;
    getrusage(RUSAGE_CHILDREN, &usage);
    return (double)usage.ru_utime.tv_sec + 1e-6 * (double)usage.ru_utime.tv_usec +
           (double)usage.ru_stime.tv_sec + 1e-6 * (double)usage.ru_stime.tv_usec;
}

/* CPU seconds of ccx, run in a temporary folder; 0 if it is not installed or fails. The folder of a
 * failed run is kept. */
static double time_ccx(const struct wb_wire_model *model)
{
    char folder[] = "/tmp/wirebench-ccx-XXXXXX", name[WB_PATH], command[2 * WB_PATH];
    struct wb_wire3d *wire = NULL;
    double spent = 0.0;

    if (system("command -v ccx >/dev/null 2>&1") != 0 || !mkdtemp(folder))
        return 0.0;
    snprintf(name, sizeof name, "%s/wire.inp", folder);
    FILE *deck = fopen(name, "w");
    if (deck && wb_wire3d_create(&wire, model) == WB_OK) {
        write_mesh(deck, wb_wire3d_mesh(wire));
        write_material(deck, &model->part[0]);
        write_history(deck, wb_wire3d_mesh(wire));
        fclose(deck);
        const double before = children_cpu();
        snprintf(command, sizeof command,
                 "cd %s && OMP_NUM_THREADS=1 ccx -i wire >log 2>&1 && ! grep -q '\\*ERROR' log",
                 folder);
        const int status = system(command);
        spent = status == 0 ? children_cpu() - before : 0.0;
        if (status != 0)
            fprintf(stderr, "ccx failed; its log is %s/log\n", folder);
    } else if (deck) {
        fclose(deck);
    }
    wb_wire3d_destroy(wire);
    if (spent > 0.0) {
        snprintf(command, sizeof command, "rm -r %s", folder);
        if (system(command) != 0)
            fprintf(stderr, "%s cannot be deleted\n", folder);
    }
    return spent;
}

static bool compare_with_ccx(void)
{
    struct wb_wire_model *model = calloc(1, sizeof *model);
    struct cost cost;
    bool good = model && read_model(model) && solve(model, &cost);

    if (good) {
        const double ccx = time_ccx(model);
        printf("solid cylinder, loading to 53 mm and unloading, one core\n\n"
               "wirebench: %d elements, %d unknowns, %d iterations, %.6f N at 53 mm, residual "
               "deflection %.3f mm\n",
               cost.elements, cost.unknowns, cost.iterations, cost.tension, cost.residual / WB_MM);
        printf("                                   CPU s\nwirebench                       %8.2f\n",
               cost.cpu);
        if (ccx > 0.0)
            printf("CalculiX, measured now          %8.2f\nratio to CalculiX               %8.4f\n",
                   ccx, cost.cpu / ccx);
        else
            printf("CalculiX, stored                %8.2f\nratio to the stored time        %8.4f "
                   "(install calculix-ccx to measure it on this machine)\n",
                   stored_ccx, cost.cpu / stored_ccx);
        printf("goal: at most 15 s; reference 0.155210 N and 33.474 mm\n\n");
    }
    free(model);
    return good;
}

/* --- growth with the number of elements --- */

/* Measures a short loading of a wire with `slices` elements along its length; *memory is the peak
 * of this process in MB. The deflection is proportional to the square of the length, so that
 * strains and iterations are similar for all lengths. */
static bool time_length(struct wb_wire_model *model, int slices, struct cost *cost, double *memory)
{
    const double longer = slices / 60.0;
    struct rusage usage;

    model->length = 85e-3 * longer;
    model->elements_along = slices;
    model->n_steps = 1;
    model->step[0].deflection = 5e-3 * longer * longer;
    model->step[0].rows = 8;
    model->gravity[1] = 0.0;
    if (!solve(model, cost))
        return false;
    getrusage(RUSAGE_SELF, &usage);
    *memory = (double)usage.ru_maxrss / 1024.0;
    return true;
}

static bool show_growth(void)
{
    static const int slices[] = {30, 60, 120, 240};
    struct wb_wire_model *model = calloc(1, sizeof *model);
    double first_time = 0.0, first_memory = 0.0, idle = 0.0;
    struct rusage usage;
    bool good = model && read_model(model);

    if (good) {
        getrusage(RUSAGE_SELF, &usage);
        idle = (double)usage.ru_maxrss / 1024.0;
        puts("along  elements  unknowns  iterations  CPU s  growth   memory MB  growth");
    }
    for (size_t i = 0; good && i < sizeof slices / sizeof slices[0]; i++) {
        struct cost cost;
        double memory;
        fflush(stdout);
        good = time_length(model, slices[i], &cost, &memory);
        if (!good)
            break;
        first_time = i == 0 ? cost.cpu / slices[0] : first_time;
        first_memory = i == 0 ? fmax(memory - idle, 1e-3) / slices[0] : first_memory;
        printf("%5d  %8d  %8d  %10d  %5.2f  %6.2f  %10.1f  %6.2f\n", slices[i], cost.elements,
               cost.unknowns, cost.iterations, cost.cpu, cost.cpu / slices[i] / first_time, memory,
               (memory - idle) / slices[i] / first_memory);
    }
    free(model);
    return good;
}

int main(void)
{
    /* The peak memory of a process never decreases: this part comes first and goes from the
     * shortest wire to the longest. */
    if (!show_growth()) {
        fprintf(stderr, "the benchmark did not converge\n");
        return EXIT_FAILURE;
    }
    puts("growth: time and memory per element along the wire, relative to the shortest wire; 1 is "
         "linear growth\n");
    if (!compare_with_ccx()) {
        fprintf(stderr, "the benchmark did not converge\n");
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
