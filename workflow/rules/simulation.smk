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
        code=stage_digest(*SIMULATION),
    shell:
        "tetgan simulation-study {input.samples:q} {output.study:q} --options {params.options:q}"
        " --identity {params.identity:q} >{log:q} 2>&1"


rule make_simulation_table:
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
        "<logs>/make_simulation_table.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=500,
    params:
        code=stage_digest("studies/simulation_table", "evaluation/markdown"),
    shell:
        "tetgan simulation-table {input.studies:q} {output.table:q} >{log:q} 2>&1"


rule draw_simulation:
    input:
        samples=each_mode(
            "<results>/samples/{{category}}/{model}/{seed}/{mode}",
            SIMULATED[:1],
            modes=SETTINGS.shown_mode,
            seeds=config["seeds"][:1],
        ),
    output:
        picture=report(
            "<results>/figures/{category}/simulation.png",
            caption="../report/simulation.rst",
            category="Figures",
            labels={"category": "{category}", "figure": "simulation"},
        ),
        mesh="<results>/figures/{category}/simulation.vtu",
        data="<results>/figures/{category}/simulation.csv",
    log:
        "<logs>/draw_simulation/{category}.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=2000,
    params:
        name=SIMULATED[0] if SIMULATED else "",
        options=section("studies", "simulation"),
        code=stage_digest("rendering", *SIMULATION),
    script:
        "../scripts/draw_simulation.py"
