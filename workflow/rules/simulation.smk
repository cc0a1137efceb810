"""Samples under load: linear elasticity on the generated tets, as they are.

Inputs: folders of samples. Outputs: one row per sample under <results>/studies/simulation, a table of all models and
modes, and for each category a picture of one sample, with its mesh (.vtu).
"""

SIMULATED = SETTINGS.studies.simulation.models
if SIMULATED:
    PAPER_TARGETS += [
        "<results>/tables/simulation.csv",
        *expand(
            "<results>/figures/{category}/simulation.png",
            category=config["categories"],
        ),
    ]


rule simulate_samples:
    input:
        samples="<results>/samples/{category}/{model}/{seed}/{mode}",
    output:
        study="<results>/studies/simulation/{category}/{model}/{seed}/{mode}.csv",
    log:
        "<logs>/simulate_samples/{category}/{model}/{seed}/{mode}.log",
    benchmark:
        "<benchmarks>/simulate_samples/{category}/{model}/{seed}/{mode}.tsv"
    conda:
        "../envs/tetgan.yaml"
    threads: 1
    resources:
        mem_mb=3000,
    params:
        options=section("studies", "simulation"),
        identity=study_identity,
        code=code_digest("tetgan.mechanics.study:simulate_samples"),
    shell:
        "tetgan simulate-samples {input.samples:q} {output.study:q} --options {params.options:q}"
        " --identity {params.identity:q} >{log:q} 2>&1"


rule tabulate_simulation:
    input:
        studies=expand(
            each_mode(
                "<results>/studies/simulation/{{category}}/{model}/{seed}/{mode}.csv",
                SIMULATED,
            ),
            category=config["categories"],
        ),
    output:
        table=report(
            "<results>/tables/simulation.csv",
            caption="../report/simulation.rst",
            category="Tables",
            labels={"study": "simulation"},
        ),
        readable="<results>/tables/simulation.md",
    log:
        "<logs>/tabulate_simulation.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=500,
    params:
        code=code_digest("tetgan.mechanics.table:tabulate_simulation"),
    shell:
        "tetgan tabulate-simulation {input.studies:q} {output.table:q} >{log:q} 2>&1"


use rule draw as draw_simulation with:
    input:
        samples=each_mode(
            "<results>/samples/{{category}}/{model}/{seed}/{mode}",
            SIMULATED[:1],
            modes=SETTINGS.shown_mode,
            seeds=config["seeds"][:1],
        ),
    output:
        **figure("simulation"),
        mesh="<results>/figures/{category}/simulation.vtu",
    log:
        "<logs>/draw_simulation/{category}.log",
    resources:
        mem_mb=2000,
    params:
        figure="simulation",
        names=SIMULATED[:1],
        options=section("studies", "simulation"),
        code=code_digest("draw_simulation.py"),
